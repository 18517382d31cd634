// SPDX-License-Identifier: MIT
// glTF 2.0, chapter 5, as tables: one row a property that this room reads. What is not in a table
// is never looked at, so that odd animations or cameras do not stop a model from being read.
#include "gltf_schema.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pvt
{

namespace
{

enum class Kind {
    Index,   // into the collection `target`
    Indices, // a list of those
    Map,     // an object whose values are those; without `target`, any 32-bit numbers
    Integer, // minimum to maximum
    Number,
    Numbers,    // exactly `maximum` of them
    NumberList, // any number of them
    Text,
    Choice, // one of the texts in `target`, which stand between bars
    Flag,
    Object,  // with the rows of `table`
    Objects, // a list of those
};

struct Table;

struct Field {
    const char* name;
    Kind kind;
    bool required = false;
    const char* target = nullptr;
    const Table* table = nullptr;
    double minimum = 0;
    double maximum = 0;
};

struct Table {
    const Field* fields;
    std::size_t count;
};

template <std::size_t N> constexpr Table MakeTable(const Field (&fields)[N])
{
    return {fields, N};
}

// Sizes and offsets: far above any file, and exact in a double.
constexpr double kMaxSize = 1ull << 48;
// tinygltf keeps these as int.
constexpr double kMaxInt = 0x7fffffff;
constexpr bool kRequired = true, kOptional = false;

constexpr Field Index(const char* name, const char* target, bool required = kOptional)
{
    return {name, Kind::Index, required, target};
}

constexpr Field Integer(const char* name, double minimum, double maximum, bool required = kOptional)
{
    return {name, Kind::Integer, required, nullptr, nullptr, minimum, maximum};
}

constexpr Field Object(const char* name, const Table& table, bool required = kOptional)
{
    return {name, Kind::Object, required, nullptr, &table};
}

constexpr Field Objects(const char* name, const Table& table, bool required = kOptional)
{
    return {name, Kind::Objects, required, nullptr, &table};
}

constexpr Field Numbers(const char* name, int count)
{
    return {name, Kind::Numbers, kOptional, nullptr, nullptr, 0, static_cast<double>(count)};
}

constexpr Field Plain(const char* name, Kind kind, bool required = kOptional)
{
    return {name, kind, required};
}

constexpr Field kMeshoptFields[] = {
    Index("buffer", "buffers", kRequired),
    Integer("byteOffset", 0, kMaxSize),
    Integer("byteLength", 0, kMaxSize, kRequired),
    Integer("byteStride", 1, 256, kRequired),
    Integer("count", 0, kMaxSize, kRequired),
    {"mode", Kind::Choice, kRequired, "|ATTRIBUTES|TRIANGLES|INDICES|"},
    {"filter", Kind::Choice, kOptional, "|NONE|OCTAHEDRAL|QUATERNION|EXPONENTIAL|"},
};
constexpr Table kMeshopt = MakeTable(kMeshoptFields);
constexpr Field kViewExtensionFields[] = {Object("EXT_meshopt_compression", kMeshopt)};
constexpr Table kViewExtensions = MakeTable(kViewExtensionFields);
constexpr Field kBufferViewFields[] = {
    Index("buffer", "buffers", kRequired),         Integer("byteOffset", 0, kMaxSize),
    Integer("byteLength", 0, kMaxSize, kRequired), Integer("byteStride", 4, 252),
    Object("extensions", kViewExtensions),
};

constexpr Field kBufferFields[] = {
    Integer("byteLength", 0, kMaxSize, kRequired),
    Plain("uri", Kind::Text),
};

constexpr Field kSparseIndicesFields[] = {
    Index("bufferView", "bufferViews", kRequired),
    Integer("byteOffset", 0, kMaxInt),
    Integer("componentType", 5121, 5125, kRequired),
};
constexpr Table kSparseIndices = MakeTable(kSparseIndicesFields);
constexpr Field kSparseValuesFields[] = {
    Index("bufferView", "bufferViews", kRequired),
    Integer("byteOffset", 0, kMaxInt),
};
constexpr Table kSparseValues = MakeTable(kSparseValuesFields);
constexpr Field kSparseFields[] = {
    Integer("count", 0, kMaxInt, kRequired),
    Object("indices", kSparseIndices, kRequired),
    Object("values", kSparseValues, kRequired),
};
constexpr Table kSparse = MakeTable(kSparseFields);
constexpr Field kAccessorFields[] = {
    Index("bufferView", "bufferViews"),
    Integer("byteOffset", 0, kMaxSize),
    Integer("componentType", 5120, 5126, kRequired),
    Integer("count", 0, kMaxSize, kRequired),
    {"type", Kind::Choice, kRequired, "|SCALAR|VEC2|VEC3|VEC4|MAT2|MAT3|MAT4|"},
    Plain("normalized", Kind::Flag),
    Plain("min", Kind::NumberList),
    Plain("max", Kind::NumberList),
    Object("sparse", kSparse),
};

constexpr Field kDracoFields[] = {
    Index("bufferView", "bufferViews", kRequired),
    {"attributes", Kind::Map, kRequired, nullptr}, // Draco's own ids
};
constexpr Table kDraco = MakeTable(kDracoFields);
constexpr Field kPrimitiveExtensionFields[] = {Object("KHR_draco_mesh_compression", kDraco)};
constexpr Table kPrimitiveExtensions = MakeTable(kPrimitiveExtensionFields);
constexpr Field kPrimitiveFields[] = {
    {"attributes", Kind::Map, kRequired, "accessors"},
    Index("indices", "accessors"),
    Index("material", "materials"),
    Integer("mode", 0, 6),
    Object("extensions", kPrimitiveExtensions),
};
constexpr Table kPrimitive = MakeTable(kPrimitiveFields);
constexpr Field kMeshFields[] = {
    Plain("name", Kind::Text),
    Objects("primitives", kPrimitive, kRequired),
};

constexpr Field kInstancingFields[] = {{"attributes", Kind::Map, kRequired, "accessors"}};
constexpr Table kInstancing = MakeTable(kInstancingFields);
constexpr Field kNodeExtensionFields[] = {Object("EXT_mesh_gpu_instancing", kInstancing)};
constexpr Table kNodeExtensions = MakeTable(kNodeExtensionFields);
constexpr Field kNodeFields[] = {
    Plain("name", Kind::Text),
    Index("mesh", "meshes"),
    Index("skin", "skins"),
    {"children", Kind::Indices, kOptional, "nodes"},
    Numbers("matrix", 16),
    Numbers("translation", 3),
    Numbers("rotation", 4),
    Numbers("scale", 3),
    Object("extensions", kNodeExtensions),
};

constexpr Field kSceneFields[] = {{"nodes", Kind::Indices, kOptional, "nodes"}};

constexpr Field kSkinFields[] = {
    Index("inverseBindMatrices", "accessors"),
    {"joints", Kind::Indices, kRequired, "nodes"},
};

constexpr Field kTextureTransformFields[] = {
    Numbers("offset", 2),
    Plain("rotation", Kind::Number),
    Numbers("scale", 2),
    Integer("texCoord", 0, kMaxInt),
};
constexpr Table kTextureTransform = MakeTable(kTextureTransformFields);
constexpr Field kTextureInfoExtensionFields[] = {
    Object("KHR_texture_transform", kTextureTransform),
};
constexpr Table kTextureInfoExtensions = MakeTable(kTextureInfoExtensionFields);
constexpr Field kTextureInfoFields[] = {
    Index("index", "textures", kRequired),
    Integer("texCoord", 0, kMaxInt),
    Object("extensions", kTextureInfoExtensions),
};
constexpr Table kTextureInfo = MakeTable(kTextureInfoFields);
constexpr Field kRoughnessFields[] = {
    Object("baseColorTexture", kTextureInfo),
    Numbers("baseColorFactor", 4),
};
constexpr Table kRoughness = MakeTable(kRoughnessFields);
constexpr Field kMaterialFields[] = {
    Plain("name", Kind::Text),
    Plain("alphaMode", Kind::Text),
    Plain("alphaCutoff", Kind::Number),
    Object("pbrMetallicRoughness", kRoughness),
};

constexpr Field kTextureSourceFields[] = {Index("source", "images")};
constexpr Table kTextureSource = MakeTable(kTextureSourceFields);
constexpr Field kTextureExtensionFields[] = {
    Object("EXT_texture_webp", kTextureSource),
    Object("EXT_texture_avif", kTextureSource),
    Object("KHR_texture_basisu", kTextureSource),
    Object("MSFT_texture_dds", kTextureSource),
};
constexpr Table kTextureExtensions = MakeTable(kTextureExtensionFields);
constexpr Field kTextureFields[] = {
    Index("source", "images"),
    Index("sampler", "samplers"),
    Object("extensions", kTextureExtensions),
};
constexpr Field kSamplerFields[] = {
    Integer("wrapS", 0, kMaxInt),
    Integer("wrapT", 0, kMaxInt),
};
constexpr Field kImageFields[] = {
    Index("bufferView", "bufferViews"),
    Plain("uri", Kind::Text),
    Plain("name", Kind::Text),
};

constexpr Table kBuffer = MakeTable(kBufferFields);
constexpr Table kBufferView = MakeTable(kBufferViewFields);
constexpr Table kAccessor = MakeTable(kAccessorFields);
constexpr Table kMaterial = MakeTable(kMaterialFields);
constexpr Table kMesh = MakeTable(kMeshFields);
constexpr Table kNode = MakeTable(kNodeFields);
constexpr Table kScene = MakeTable(kSceneFields);
constexpr Table kSkin = MakeTable(kSkinFields);
constexpr Table kTexture = MakeTable(kTextureFields);
constexpr Table kSampler = MakeTable(kSamplerFields);
constexpr Table kImage = MakeTable(kImageFields);
constexpr Field kDocumentFields[] = {
    Index("scene", "scenes"),
    Objects("buffers", kBuffer),
    Objects("bufferViews", kBufferView),
    Objects("accessors", kAccessor),
    Objects("images", kImage),
    Objects("textures", kTexture),
    Objects("samplers", kSampler),
    Objects("materials", kMaterial),
    Objects("meshes", kMesh),
    Objects("nodes", kNode),
    Objects("scenes", kScene),
    Objects("skins", kSkin),
};
constexpr Table kDocument = MakeTable(kDocumentFields);

class Checker
{
  public:
    Checker(const pvtLoadJob& job, const Json& document) : job_(job), document_(document)
    {
    }

    void CheckObject(Json& object, const Table& table, const std::string& place)
    {
        if (!object.is_object()) {
            Refuse(job_, "%s is not an object", place.empty() ? "the JSON" : place.c_str());
        }
        for (std::size_t i = 0; i < table.count; ++i) {
            const Field& field = table.fields[i];
            const std::string path = place.empty() ? field.name : place + "." + field.name;
            const auto found = object.find(field.name);
            if (found != object.end()) {
                CheckValue(*found, field, path);
            } else if (field.required) {
                Refuse(job_, "%s is missing", path.c_str());
            }
        }
    }

  private:
    void CheckValue(Json& value, const Field& field, const std::string& place)
    {
        switch (field.kind) {
        case Kind::Index:
            return CheckIndex(value, field, place);
        case Kind::Integer:
            return CheckInteger(value, field.minimum, field.maximum, place);
        case Kind::Indices:
        case Kind::Map:
            return CheckIndices(value, field, place);
        case Kind::Numbers:
            return CheckNumbers(value, static_cast<std::size_t>(field.maximum), place);
        case Kind::NumberList:
            return CheckNumbers(value, value.size(), place);
        case Kind::Number:
            return Expect(value.is_number(), "a number", place);
        case Kind::Text:
            return Expect(value.is_string(), "a string", place);
        case Kind::Choice:
            return CheckChoice(value, field.target, place);
        case Kind::Flag:
            return Expect(value.is_boolean(), "true or false", place);
        case Kind::Object:
            return CheckObject(value, *field.table, place);
        case Kind::Objects:
            return CheckObjects(value, field, place);
        }
    }

    void Expect(bool holds, const char* what, const std::string& place) const
    {
        if (!holds) {
            Refuse(job_, "%s is not %s", place.c_str(), what);
        }
    }

    void CheckChoice(const Json& value, const std::string& choices, const std::string& place) const
    {
        const std::string text = value.is_string() ? value.get<std::string>() : "";
        if (text.empty() || text.find('|') != std::string::npos ||
            choices.find("|" + text + "|") == std::string::npos) {
            std::string listed;
            for (size_t i = 1; i + 1 < choices.size(); ++i) {
                listed += choices[i] == '|' ? std::string(", ") : std::string(1, choices[i]);
            }
            Refuse(job_, "%s is %s; it must be one of %s", place.c_str(),
                   Clean(value.dump()).c_str(), listed.c_str());
        }
    }

    void CheckInteger(Json& value, double minimum, double maximum, const std::string& place) const
    {
        const double number = value.is_number() ? value.get<double>() : -1.0;
        Expect(value.is_number() && std::floor(number) == number, "an integer", place);
        if (number < minimum || number > maximum) {
            Refuse(job_, "%s is %.15g; it must be %.15g to %.15g", place.c_str(), number, minimum,
                   maximum);
        }
        if (!value.is_number_unsigned()) {
            value = static_cast<std::uint64_t>(number);
        }
    }

    void CheckIndex(Json& value, const Field& field, const std::string& place) const
    {
        CheckInteger(value, 0, kMaxInt, place);
        const std::size_t count = GetCount(document_, field.target);
        const std::size_t index = value.get<std::size_t>();
        if (index >= count) {
            Refuse(job_, "%s is %zu, but there are only %zu %s", place.c_str(), index, count,
                   field.target);
        }
    }

    void CheckIndices(Json& values, const Field& field, const std::string& place) const
    {
        const bool map = field.kind == Kind::Map;
        Expect(map ? values.is_object() : values.is_array(), map ? "an object" : "a list", place);
        for (auto it = values.begin(); it != values.end(); ++it) {
            const std::string name =
                map ? "." + Clean(it.key()) : "[" + std::to_string(it - values.begin()) + "]";
            if (field.target == nullptr) {
                CheckInteger(*it, 0, UINT32_MAX, place + name);
            } else {
                CheckIndex(*it, field, place + name);
            }
        }
    }

    void CheckNumbers(const Json& values, std::size_t count, const std::string& place) const
    {
        if (!values.is_array() || values.size() != count) {
            Refuse(job_, "%s is not a list of %zu numbers", place.c_str(), count);
        }
        for (const Json& value : values) {
            Expect(value.is_number(), "a list of numbers", place);
        }
    }

    void CheckObjects(Json& values, const Field& field, const std::string& place)
    {
        Expect(values.is_array(), "a list", place);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if ((i & 0xfff) == 0) {
                Poll(job_.context);
            }
            CheckObject(values[i], *field.table, place + "[" + std::to_string(i) + "]");
        }
    }

    const pvtLoadJob& job_;
    const Json& document_;
};

// What is implemented here, and what changes how things look but not where they are.
bool IsKnownExtension(const std::string& name)
{
    static const char* const known[] = {
        "KHR_mesh_quantization",      "EXT_meshopt_compression", "EXT_mesh_gpu_instancing",
        "KHR_draco_mesh_compression", "KHR_texture_transform",   "KHR_texture_basisu",
        "KHR_lights_punctual",        "KHR_xmp_json_ld",         "KHR_animation_pointer",
        "EXT_texture_webp",           "EXT_texture_avif",        "EXT_lights_image_based",
        "MSFT_texture_dds",
    };
    for (const char* each : known) {
        if (name == each) {
            return true;
        }
    }
    return name.rfind("KHR_materials_", 0) == 0;
}

void CheckExtensions(const pvtLoadJob& job, const Json& document)
{
    const auto required = document.find("extensionsRequired");
    if (required == document.end()) {
        return;
    }
    for (const Json& name : *required) {
        if (!required->is_array() || !name.is_string()) {
            Refuse(job, "extensionsRequired is not a list of strings");
        }
        if (!IsKnownExtension(name.get<std::string>())) {
            Refuse(job, PVT_UNSUPPORTED,
                   "the file requires the extension %s, which is not supported; export it without",
                   Clean(name.get<std::string>()).c_str());
        }
    }
}

void CheckVersion(const pvtLoadJob& job, const Json& document)
{
    const auto asset = document.find("asset");
    if (asset == document.end() || !asset->is_object()) {
        Refuse(job, "the JSON has no asset; it is not glTF 2.0");
    }
    const auto version = asset->find("version");
    if (version == asset->end() || !version->is_string()) {
        Refuse(job, "asset.version is missing; it is not glTF 2.0");
    }
    const std::string text = version->get<std::string>();
    if (text.rfind("2.", 0) != 0) {
        Refuse(job, PVT_UNSUPPORTED, "glTF version %s is not supported; convert it to 2.0",
               Clean(text).c_str());
    }
    const auto minimum = asset->find("minVersion");
    if (minimum != asset->end() && *minimum != "2.0") {
        Refuse(job, PVT_UNSUPPORTED,
               "the file asks for a reader of glTF %s or newer; export it as "
               "2.0",
               Clean(minimum->dump()).c_str());
    }
}

} // namespace

std::size_t GetCount(const Json& document, const char* name)
{
    const auto found = document.find(name);
    return found != document.end() && found->is_array() ? found->size() : 0;
}

bool IsExtensionListed(const Json& document, const char* list, const char* name)
{
    const auto names = document.find(list);
    return names != document.end() && std::find(names->begin(), names->end(), name) != names->end();
}

const Json* FindExtension(const Json& owner, const char* name)
{
    const auto extensions = owner.find("extensions");
    if (extensions == owner.end() || !extensions->is_object()) {
        return nullptr;
    }
    const auto found = extensions->find(name);
    return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

void CheckGltfSchema(const pvtLoadJob& job, Json& document)
{
    if (!document.is_object()) {
        Refuse(job, "the JSON is not an object");
    }
    CheckVersion(job, document);
    CheckExtensions(job, document);
    Checker(job, document).CheckObject(document, kDocument, "");
}

} // namespace pvt
