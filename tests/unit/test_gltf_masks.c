// SPDX-License-Identifier: MIT
// Masked materials of glTF: of a card of one square metre there is just as much as its texture,
// its vertices and its factors leave opaque for sure.
#include "gltf_fixture.h"

#include "failures.h"

// A card: 4 positions, their texture coordinates once as they are, once from −1 to 2, once in 16
// bits, and colours whose alpha falls from 1 at x = 0 to 0.5 at x = 1.
static const float kPositions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
static const float kTexCoords[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
static const float kWide[4][2] = {{-1, 0}, {2, 0}, {2, 1}, {-1, 1}};
static const uint16_t kShort[4][2] = {{0, 0}, {65535, 0}, {65535, 65535}, {0, 65535}};
static const float kColors[4][4] = {{1, 1, 1, 1}, {1, 1, 1, 0.5f}, {1, 1, 1, 0.5f}, {1, 1, 1, 1}};
static const uint16_t kIndices[6] = {0, 1, 2, 0, 2, 3};

enum { POSITIONS, TEX_COORDS, INDICES, WIDE, SHORT, COLORS, FEW };
enum { CARD_BYTES = 204 };

static Pack PackCard(void)
{
    Pack pack = {.size = 0};
    PackBytes(&pack, kPositions, sizeof kPositions);
    PackBytes(&pack, kTexCoords, sizeof kTexCoords);
    PackBytes(&pack, kIndices, sizeof kIndices);
    PackBytes(&pack, kWide, sizeof kWide);
    PackBytes(&pack, kShort, sizeof kShort);
    PackBytes(&pack, kColors, sizeof kColors);
    assert_int_equal(pack.size, CARD_BYTES);
    return pack;
}

#define CARD_ACCESSORS                                                                             \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"                  \
    "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC2'},"                               \
    "{'bufferView':2,'componentType':5123,'count':6,'type':'SCALAR'},"                             \
    "{'bufferView':3,'componentType':5126,'count':4,'type':'VEC2'},"                               \
    "{'bufferView':4,'componentType':5123,'count':4,'type':'VEC2','normalized':true},"             \
    "{'bufferView':5,'componentType':5126,'count':4,'type':'VEC4'},"                               \
    "{'bufferView':1,'componentType':5126,'count':3,'type':'VEC2'}],"
#define CARD_VIEWS                                                                                 \
    "{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':32},"                   \
    "{'buffer':0,'byteOffset':80,'byteLength':12},{'buffer':0,'byteOffset':92,'byteLength':32},"   \
    "{'buffer':0,'byteOffset':124,'byteLength':16},{'buffer':0,'byteOffset':140,'byteLength':64}"

// What a test changes about the card. Null: nothing of the kind.
typedef struct Card {
    const char* attributes; // behind POSITION
    const char* material;   // between the braces, behind alphaMode
    const char* image;      // between the braces
    const char* sampler;    // the same
    const char* texture;    // the same; null: the image and the sampler
    const char* more;       // at the end of the document; null: one node
} Card;

static const char kPlain[] = "'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}";
static const char kTex0[] = "'TEXCOORD_0':1";

static const char* Or(const char* text, const char* other)
{
    return text != NULL ? text : other;
}

// The card in model.glb, with `bytes` in buffer view 6.
static pvtStatus LoadCardWith(Fixture* f, const Card* card, const void* bytes, size_t size)
{
    Pack pack = PackCard();
    PackBytes(&pack, bytes, size);
    char* json = malloc(1 << 18);
    assert_non_null(json);
    const char* attributes = Or(card->attributes, kTex0);
    (void)snprintf(
        json, 1 << 18,
        "{" ASSET "'buffers':[{'byteLength':%zu}],'bufferViews':[" CARD_VIEWS
        ",{'buffer':0,'byteOffset':204,'byteLength':%zu}]," CARD_ACCESSORS
        "'materials':[{'alphaMode':'MASK',%s}],'textures':[{%s}],'images':[{%s}],'samplers':[{%s}],"
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0%s%s},'indices':2,'material':0}]}],%"
        "s}",
        pack.size, size > 0 ? size : 1, Or(card->material, kPlain),
        Or(card->texture, "'source':0,'sampler':0"), Or(card->image, "'uri':'mask.png'"),
        Or(card->sampler, "'wrapS':33071,'wrapT':33071"), attributes[0] != '\0' ? "," : "",
        attributes, Or(card->more, "'nodes':[{'mesh':0}]"));
    const pvtStatus status = LoadGlb(f, json, &pack);
    free(json);
    return status;
}

static pvtStatus LoadCard(Fixture* f, const Card* card)
{
    return LoadCardWith(f, card, "", 0);
}

// An image in the folder; `alpha` has one character a texel, of which '#' is opaque, '+' has alpha
// 128 and '.' none.
static void WriteMask(Fixture* f, const char* name, int width, int height, const char* alpha)
{
    pvtImage image;
    CHECK_OK(f->context, pvtCreateImage(f->context, width, height, &image));
    for (int i = 0; i < width * height; ++i) {
        image.pixels[4 * i + 3] = alpha[i] == '#' ? 255 : alpha[i] == '+' ? 128 : 0;
    }
    CHECK_OK(f->context, pvtSaveImage(f->context, InFolder(&f->folder, name), &image));
    pvtImage_Free(f->context, &image);
}

// Four columns of eight opaque: up to 3.5 texels nothing else is mixed in.
static void WriteHalf(Fixture* f, const char* name)
{
    WriteMask(f, name, 8, 2, "####....####....");
}
static const double kHalf = 3.5 / 8.0;

static size_t ReadAll(Fixture* f, const char* name, uint8_t* bytes, size_t room)
{
    FILE* file = fopen(InFolder(&f->folder, name), "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, room, file);
    assert_int_equal(fclose(file), 0);
    assert_true(size < room);
    return size;
}

static void PutWord(uint8_t* at, uint32_t word)
{
    for (int i = 0; i < 4; ++i) {
        at[i] = (uint8_t)(word >> (24 - 8 * i));
    }
}

// Length, type and checksum around a chunk's data.
static void SealChunk(uint8_t* chunk, const char* type, uint32_t length)
{
    PutWord(chunk, length);
    memcpy(chunk + 4, type, 4);
    uint32_t crc = UINT32_MAX;
    for (uint32_t i = 4; i < 8 + length; ++i) {
        crc ^= chunk[i];
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320u : 0);
        }
    }
    PutWord(chunk + 8 + length, ~crc);
}

static void ClaimSide(uint8_t* png, uint32_t side)
{
    PutWord(png + 16, side);
    PutWord(png + 20, side);
    SealChunk(png + 8, "IHDR", 13);
}

// The card lies in the plane z = 0 and faces z.
static double GetArea(const pvtMesh* mesh)
{
    double sum = 0.0;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        const pvtVec3 a = mesh->positions[mesh->indices[3 * t]];
        const pvtVec3 b = mesh->positions[mesh->indices[3 * t + 1]];
        const pvtVec3 c = mesh->positions[mesh->indices[3 * t + 2]];
        sum += 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    }
    return sum;
}

static void CheckArea(Fixture* f, const Card* card, double area)
{
    CHECK_OK(f->context, LoadCard(f, card));
    CHECK_NEAR(GetArea(&f->model.mesh), area, 1e-6);
}

static void a_card_is_cut_to_what_is_opaque(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "mask.png");
    const Card card = {0};
    CheckArea(f, &card, kHalf);
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){kHalf, 1, 0}, 1e-6);
    assert_string_equal(f->warnings.text, "");
    // Both triangles once, the second one's part beside the diagonal.
    assert_true(f->model.mesh.triangleCount <= 4);
    f->options.masked = PVT_MASKED_OPAQUE;
    CheckArea(f, &card, 1.0);
    assert_int_equal(f->model.mesh.triangleCount, 2);
    f->options.masked = PVT_MASKED_SKIP;
    CheckRefused(f, LoadCard(f, &card), PVT_INVALID_INPUT, "--masked opaque");
}

static void CheckSameMesh(const pvtMesh* a, const pvtMesh* b)
{
    assert_int_equal(a->triangleCount, b->triangleCount);
    assert_int_equal(a->positionCount, b->positionCount);
    assert_memory_equal(a->indices, b->indices, 3 * a->triangleCount * sizeof *a->indices);
    assert_memory_equal(a->positions, b->positions, a->positionCount * sizeof *a->positions);
}

static void an_opaque_texture_is_a_wall_and_a_transparent_one_is_nothing(void** state)
{
    Fixture* f = *state;
    const Card card = {0};
    f->options.masked = PVT_MASKED_OPAQUE;
    CHECK_OK(f->context, LoadCard(f, &card));
    const pvtMesh wall = f->model.mesh;
    f->model.mesh = (pvtMesh){0};
    f->options.masked = PVT_MASKED_AUTO;
    WriteMask(f, "mask.png", 4, 1, "####");
    CHECK_OK(f->context, LoadCard(f, &card));
    CheckSameMesh(&f->model.mesh, &wall);
    // Only its border is not: the mesh needs none of it.
    WriteMask(f, "mask.png", 8, 8,
              "........"
              ".######."
              ".######."
              ".######."
              ".######."
              ".######."
              ".######."
              "........");
    const Card inner = {.material = "'pbrMetallicRoughness':{'baseColorTexture':{'index':0,"
                                    "'extensions':{'KHR_texture_transform':{'offset':[0.25,0.25],"
                                    "'scale':[0.5,0.5]}}}}"};
    CHECK_OK(f->context, LoadCard(f, &inner));
    CheckSameMesh(&f->model.mesh, &wall);
    pvtMesh allOfIt = wall;
    pvtMesh_Free(f->context, &allOfIt);

    WriteMask(f, "mask.png", 4, 1, "....");
    CheckRefused(f, LoadCard(f, &card), PVT_NOTHING_INSIDE, "--masked opaque");
    // JPEG has no alpha. Nothing of it is read.
    WriteText(InFolder(&f->folder, "mask.png"), "\xff\xd8\xff\xe0 and so on");
    CheckArea(f, &card, 1.0);
}

static void images_are_read_wherever_they_lie(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "a mask.png");
    const Card named = {.image = "'uri':'a%20mask.png'"};
    CheckArea(f, &named, kHalf);
    uint8_t png[4096];
    const size_t size = ReadAll(f, "a mask.png", png, sizeof png);
    const Card viewed = {.image = "'bufferView':6,'mimeType':'image/png'"};
    CHECK_OK(f->context, LoadCardWith(f, &viewed, png, size));
    CHECK_NEAR(GetArea(&f->model.mesh), kHalf, 1e-6);

    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char uri[8192] = "'uri':'data:image/png;base64,";
    size_t length = strlen(uri);
    for (size_t i = 0; i < size; i += 3) {
        const uint32_t bits = (uint32_t)png[i] << 16 |
                              (uint32_t)(i + 1 < size ? png[i + 1] : 0) << 8 |
                              (i + 2 < size ? png[i + 2] : 0);
        for (int k = 0; k < 4; ++k) {
            const bool isPadding = i + (size_t)k > size;
            uri[length++] = isPadding ? '=' : digits[bits >> (18 - 6 * k) & 63];
        }
    }
    (void)snprintf(uri + length, sizeof uri - length, "'");
    const Card inlined = {.image = uri};
    CheckArea(f, &inlined, kHalf);

    // The same in WebP, lossless.
    static const uint8_t webp[] = {0x52, 0x49, 0x46, 0x46, 0x1e, 0x00, 0x00, 0x00, 0x57, 0x45,
                                   0x42, 0x50, 0x56, 0x50, 0x38, 0x4c, 0x11, 0x00, 0x00, 0x00,
                                   0x2f, 0x07, 0xc0, 0x01, 0x10, 0x0f, 0x30, 0x59, 0x11, 0xf3,
                                   0x1f, 0x8c, 0x3e, 0x44, 0xf4, 0x3f, 0x00, 0x00};
    WriteBytes(InFolder(&f->folder, "mask.webp"), webp, sizeof webp);
    const Card other = {.image = "'uri':'mask.webp'",
                        .texture = "'sampler':0,'extensions':{'EXT_texture_webp':{'source':0}}"};
    CheckArea(f, &other, kHalf);
}

static void wrap_modes_say_what_lies_beyond_the_image(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "mask.png");
    // Three images wide: each is a third. Repeated, an image's first half texel mixes with the
    // last.
    const struct {
        const char* sampler;
        double area;
    } cases[] = {
        {"'wrapS':10497,'wrapT':33071", 3.0 / 8.0},
        {"", 3.0 / 8.0}, // repeats
        // Opaque throughout beyond the left edge, but for what is mirrored there: images run
        // "....####", "####....", "....####".
        {"'wrapS':33648,'wrapT':33648", (3.5 + 3.5 + 3.5) / 24.0},
        {"'wrapS':33071", (8.0 + 3.5) / 24.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const Card card = {.attributes = "'TEXCOORD_0':3", .sampler = cases[i].sampler};
        CheckArea(f, &card, cases[i].area);
    }
    const Card odd = {.sampler = "'wrapS':1"};
    CheckRefused(f, LoadCard(f, &odd), PVT_INVALID_INPUT, "samplers[0].wrapS is 1");
}

static void texture_coordinates_are_taken_as_the_material_says(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "mask.png");
#define INFO(rest) "'pbrMetallicRoughness':{'baseColorTexture':{'index':0," rest "}}"
#define TRANSFORM(rest) INFO("'extensions':{'KHR_texture_transform':{" rest "}}")
    const struct {
        const char *attributes, *material;
        pvtVec3 lower, upper;
    } cases[] = {
        {"'TEXCOORD_0':4", kPlain, {0, 0, 0}, {kHalf, 1, 0}},
        {"'TEXCOORD_0':3,'TEXCOORD_1':1", INFO("'texCoord':1"), {0, 0, 0}, {kHalf, 1, 0}},
        {"'TEXCOORD_0':3,'TEXCOORD_2':1", TRANSFORM("'texCoord':2"), {0, 0, 0}, {kHalf, 1, 0}},
        {kTex0, TRANSFORM("'scale':[0.5,1]"), {0, 0, 0}, {2 * kHalf, 1, 0}},
        {kTex0, TRANSFORM("'offset':[-0.25,7]"), {0, 0, 0}, {kHalf + 0.25, 1, 0}},
        // A quarter turn: u is v of before, as every renderer has it, so that the opaque half
        // lies at small y; turned the other way it would be clamped, and everywhere.
        {kTex0, TRANSFORM("'rotation':1.5707963267948966"), {0, 0, 0}, {1, kHalf, 0}},
        // Scaled before it is turned, moved after.
        {kTex0,
         TRANSFORM("'rotation':1.5707963267948966,'scale':[9,0.5],'offset':[0.125,0]"),
         {0, 0, 0},
         {1, 2 * (kHalf - 0.125), 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const Card card = {.attributes = cases[i].attributes, .material = cases[i].material};
        CHECK_OK(f->context, LoadCard(f, &card));
        CheckBounds(&f->model.mesh, cases[i].lower, cases[i].upper, 1e-5);
    }
    const Card lost = {.attributes = "'TEXCOORD_1':1"};
    CheckRefused(f, LoadCard(f, &lost), PVT_INVALID_INPUT, "--masked opaque");
    const Card few = {.attributes = "'TEXCOORD_0':6"};
    CheckRefused(f, LoadCard(f, &few), PVT_INVALID_INPUT, "counts 3 elements, but 4 are positions");
    const Card wrong = {.attributes = "'TEXCOORD_0':0"};
    CheckRefused(f, LoadCard(f, &wrong), PVT_INVALID_INPUT, "TEXCOORD_0 is a VEC3 of FLOAT");
    const Card colored = {.attributes = "'TEXCOORD_0':1,'COLOR_0':1"};
    CheckRefused(f, LoadCard(f, &colored), PVT_INVALID_INPUT, "COLOR_0 is a VEC2 of FLOAT");
}

static void factor_vertices_and_cutoff_decide_with_the_texture(void** state)
{
    Fixture* f = *state;
    WriteMask(f, "mask.png", 2, 1, "++");
#define BASE(rest) "'pbrMetallicRoughness':{'baseColorTexture':{'index':0}" rest "}"
#define FACTOR(alpha) ",'baseColorFactor':[1,1,1," alpha "]"
    const struct {
        const char *attributes, *material;
        bool isOpaque;
    } cases[] = {
        {kTex0, BASE(""), true}, // 128/255 is above 0.5
        {kTex0, "'alphaCutoff':0.501960784313," BASE(""), true},
        {kTex0, "'alphaCutoff':0.501960784315," BASE(""), false},
        {kTex0, BASE(FACTOR("0.9")), false},
        {kTex0, "'alphaCutoff':0.45," BASE(FACTOR("0.9")), true},
        {kTex0, "'alphaCutoff':0," BASE(FACTOR("0")), true},
        // The least of a triangle's three vertices, which is 0.5 for both of them.
        {"'TEXCOORD_0':1,'COLOR_0':5", "'alphaCutoff':0.25," BASE(""), true},
        {"'TEXCOORD_0':1,'COLOR_0':5", "'alphaCutoff':0.26," BASE(""), false},
        // Colours without alpha.
        {"'TEXCOORD_0':1,'COLOR_0':0", BASE(""), true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const Card card = {.attributes = cases[i].attributes, .material = cases[i].material};
        const pvtStatus status = LoadCard(f, &card);
        if (status != (cases[i].isOpaque ? PVT_OK : PVT_NOTHING_INSIDE)) {
            fail_msg("case %zu: %s", i, pvtContext_GetMessage(f->context));
        }
        assert_int_equal(f->model.mesh.triangleCount, cases[i].isOpaque ? 2 : 0);
    }
}

// It may be a leaf, whose texture was taken off: as without its image.
static void what_else_a_png_holds_does_not_matter(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "mask.png");
    uint8_t png[4096], more[4096];
    const size_t size = ReadAll(f, "mask.png", png, sizeof png);
    // Behind the header a profile that is none, which libpng would comment on.
    memcpy(more, png, 33);
    memset(more + 33, 'x', 100);
    SealChunk(more + 33, "iCCP", 88);
    memcpy(more + 133, png + 33, size - 33);
    WriteBytes(InFolder(&f->folder, "mask.png"), more, size + 100);
    const Card card = {0};
    CheckArea(f, &card, kHalf);
    assert_string_equal(f->warnings.text, "");
}

static void a_mask_without_a_texture_is_left_out(void** state)
{
    Fixture* f = *state;
    const char* const materials[] = {"'name':'leaf'", "'alphaCutoff':0",
                                     "'pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.9]}"};
    for (size_t i = 0; i < sizeof materials / sizeof *materials; ++i) {
        const Card card = {.attributes = "'COLOR_0':5", .material = materials[i]};
        CheckRefused(f, LoadCard(f, &card), PVT_INVALID_INPUT, "--masked opaque");
        assert_non_null(
            strstr(f->warnings.text, "masked materials without a texture to be judged by: 1"));
        f->options.masked = PVT_MASKED_OPAQUE;
        CheckArea(f, &card, 1.0);
        f->options.masked = PVT_MASKED_AUTO;
    }
}

static void without_its_image_a_mask_is_left_out_with_the_reason(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "half.png");
    uint8_t png[4096];
    const size_t size = ReadAll(f, "half.png", png, sizeof png);
    WriteBytes(InFolder(&f->folder, "cut.png"), png, size - 20);
    WriteText(InFolder(&f->folder, "text.png"), "this is no picture, whatever its name says");
    WriteBytes(InFolder(&f->folder, "leaf.ktx2"), "\xabKTX 20\xbb\r\n\x1a\n", 12);
    png[60] ^= 1;
    WriteBytes(InFolder(&f->folder, "bent.png"), png, size);
    png[60] ^= 1;
    ClaimSide(png, 30000);
    WriteBytes(InFolder(&f->folder, "liar.png"), png, size);
    const struct {
        const char *image, *reason;
    } cases[] = {
        {"'uri':'gone.png'", "images[0]: \"gone.png\" cannot be read"},
        {"'uri':'../gone.png'", "leaves the model's folder"},
        {"'uri':'http://example.com/x.png'", "nothing is fetched"},
        {"'uri':'cut.png'", "images[0] \"cut.png\" cannot be read: it was cut short"},
        {"'uri':'bent.png'", "it does not match its checksum"},
        {"'uri':'text.png'", "images[0] \"text.png\" is neither PNG, JPEG nor WebP"},
        {"'uri':'leaf.ktx2'", "images[0] \"leaf.ktx2\" is neither PNG, JPEG nor WebP"},
        {"'uri':'liar.png'", "images[0] \"liar.png\" claims 30000 × 30000 pixels"},
        {"'name':'bark'", "images[0] has neither uri nor bufferView"},
        {"'bufferView':0,'name':'bark'", "images[0] \"bark\" is neither PNG"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const Card card = {.image = cases[i].image, .more = "'nodes':[{'mesh':0}]"};
        CheckRefused(f, LoadCard(f, &card), PVT_INVALID_INPUT, "--masked opaque");
        if (strstr(f->warnings.text, cases[i].reason) == NULL) {
            fail_msg("\"%s\" does not hold \"%s\"", f->warnings.text, cases[i].reason);
        }
        assert_non_null(strstr(f->warnings.text, "model.glb: "));
        f->options.masked = PVT_MASKED_OPAQUE;
        CheckArea(f, &card, 1.0);
        f->options.masked = PVT_MASKED_AUTO;
    }
    const Card sourceless = {.texture = "'sampler':0"};
    CheckRefused(f, LoadCard(f, &sourceless), PVT_INVALID_INPUT, "--masked opaque");
    const Card beyond = {.texture = "'source':7"};
    CheckRefused(f, LoadCard(f, &beyond), PVT_INVALID_INPUT, "textures[0].source is 7");
}

// A picture that could be what it says, and does not fit in memory: a limit, not a broken image.
static void an_image_beyond_the_memory_limit_is_refused_as_such(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "mask.png");
    uint8_t* png = calloc(1, 200012);
    assert_non_null(png);
    const size_t size = ReadAll(f, "mask.png", png, 4096);
    ClaimSide(png, 32768);
    // Room for as much, in front of the end.
    SealChunk(png + size - 12, "IDAT", (uint32_t)(200000 - size));
    memcpy(png + 200000, "\0\0\0\0IEND\xae\x42\x60\x82", 12);
    WriteBytes(InFolder(&f->folder, "mask.png"), png, 200012);
    free(png);
    const Card card = {0};
    CheckRefused(f, LoadCard(f, &card), PVT_LIMIT, "--masked skip");
    CheckMessage(f->context, "32768 × 32768");
}

static void coarser_looks_only_ever_lose_surface(void** state)
{
    Fixture* f = *state;
    char alpha[64 * 64];
    for (int i = 0; i < 64 * 64; ++i) {
        const double x = i % 64 - 32.0, y = i / 64 - 32.0;
        alpha[i] = x * x + y * y < 25.0 * 25.0 ? '#' : '.';
    }
    WriteMask(f, "mask.png", 64, 64, alpha);
    const Card card = {0};
    f->options.maskedResolution = 65536;
    CHECK_OK(f->context, LoadCard(f, &card));
    double area = GetArea(&f->model.mesh);
    size_t triangles = f->model.mesh.triangleCount;
    assert_true(area > 0.41 && area < 0.4794); // π (25/64)²
    for (int resolution = 32; resolution >= 4; resolution /= 2) {
        f->options.maskedResolution = resolution;
        CHECK_OK(f->context, LoadCard(f, &card));
        assert_true(GetArea(&f->model.mesh) < area);
        assert_true(f->model.mesh.triangleCount < triangles);
        // What is lost lies within a cell of the rim.
        assert_true(GetArea(&f->model.mesh) > 3.14 * pow(25.0 / 64.0 - 1.5 / resolution, 2.0));
        area = GetArea(&f->model.mesh);
        triangles = f->model.mesh.triangleCount;
    }
    // The same in world units; an instance four times as large needs cells of a quarter.
    f->options.maskedCell = 0.25;
    CheckArea(f, &card, area);
    f->options.maskedCell = 1.0;
    const Card large = {.more = "'nodes':[{'mesh':0,'scale':[4,4,4]}]"};
    CheckArea(f, &large, 16.0 * area);
    f->options.maskedCell = -1.0;
    assert_int_equal(LoadCard(f, &card), PVT_INVALID_ARGUMENT);
    f->options = pvtDefaultLoadOptions();
    f->options.maskedResolution = 0;
    assert_int_equal(LoadCard(f, &card), PVT_INVALID_ARGUMENT);
}

// Two cards far apart: cells of the scene are larger than they are, cells of their own are not.
static void a_mesh_that_is_kept_is_looked_at_by_itself(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "mask.png");
    const Card card = {0};
    const Card far = {.more = "'nodes':[{'mesh':0},{'mesh':0,'translation':[900,0,0],"
                              "'scale':[3,3,3]}]"};
    f->options.maskedResolution = 64;
    f->options.keepMeshes = true;
    CHECK_OK(f->context, LoadCard(f, &card));
    const double area = GetArea(&f->model.mesh);
    assert_true(area > 0.4);
    CHECK_OK(f->context, LoadCard(f, &far));
    CHECK_NEAR(GetArea(&f->model.mesh), 10.0 * area, 1e-9);
    assert_int_equal(f->model.meshCount, 1);
    CHECK_NEAR(GetArea(&f->model.meshes[0]), area, 1e-9);
    f->options.keepMeshes = false;
    assert_true(LoadCard(f, &far) != PVT_OK || GetArea(&f->model.mesh) < 5.0 * area);
}

// `count` nodes with the card, as the end of a document.
static void PrintNodes(char* text, size_t room, int count)
{
    size_t length = (size_t)snprintf(text, room, "'scenes':[{'nodes':[0");
    for (int i = 1; i < count; ++i) {
        length += (size_t)snprintf(text + length, room - length, ",%d", i);
    }
    length += (size_t)snprintf(text + length, room - length, "]}],'nodes':[{'mesh':0}");
    for (int i = 1; i < count; ++i) {
        length += (size_t)snprintf(text + length, room - length, ",{'mesh':0}");
    }
    (void)snprintf(text + length, room - length, "]");
}

static void millions_of_pieces_are_looked_at_less_closely_with_a_warning(void** state)
{
    Fixture* f = *state;
    // A large square and ten small ones, all of which come back 3600 times.
    WriteMask(f, "mask.png", 16, 16,
              "##.##.##.##..##."
              "##.##.##.##..##."
              "................"
              "................"
              "....########...."
              "....########...."
              "....########...."
              "....########...."
              "....########...."
              "....########...."
              "....########...."
              "....########...."
              "................"
              "##.##.##.##..##."
              "##.##.##.##..##."
              "................");
    f->options.maskedResolution = 65536;
    char more[4096];
    PrintNodes(more, sizeof more, 60);
    const Card card = {.material = "'pbrMetallicRoughness':{'baseColorTexture':{'index':0,"
                                   "'extensions':{'KHR_texture_transform':{'scale':[60,60]}}}}",
                       .sampler = "'wrapS':10497",
                       .more = more};
    CHECK_OK(f->context, LoadCard(f, &card));
    assert_non_null(strstr(f->warnings.text, "millions of triangles"));
    assert_true(f->model.mesh.triangleCount < (4u << 20));
    // 7 × 7 cells and ten more without, 6 × 6 with twice as large cells.
    CHECK_NEAR(GetArea(&f->model.mesh), 60.0 * 36.0 / 256.0, 1e-3);
}

static pvtStatus LoadStage(pvtContext* context, const void* input)
{
    pvtModel model;
    const pvtStatus status = pvtLoadModel(context, NULL, input, &model);
    pvtModel_Free(context, &model);
    return status;
}

static void failures_and_cancels_leave_nothing_behind(void** state)
{
    Fixture* f = *state;
    WriteHalf(f, "mask.png");
    const Card card = {0};
    CHECK_OK(f->context, LoadCard(f, &card));
    char path[256];
    (void)snprintf(path, sizeof path, "%s", InFolder(&f->folder, "model.glb"));
    CheckEveryAllocation(LoadStage, path);
    CheckEveryCancel(LoadStage, path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_card_is_cut_to_what_is_opaque),
        TEST(an_opaque_texture_is_a_wall_and_a_transparent_one_is_nothing),
        TEST(images_are_read_wherever_they_lie),
        TEST(wrap_modes_say_what_lies_beyond_the_image),
        TEST(texture_coordinates_are_taken_as_the_material_says),
        TEST(factor_vertices_and_cutoff_decide_with_the_texture),
        TEST(what_else_a_png_holds_does_not_matter),
        TEST(a_mask_without_a_texture_is_left_out),
        TEST(without_its_image_a_mask_is_left_out_with_the_reason),
        TEST(an_image_beyond_the_memory_limit_is_refused_as_such),
        TEST(coarser_looks_only_ever_lose_surface),
        TEST(a_mesh_that_is_kept_is_looked_at_by_itself),
        TEST(millions_of_pieces_are_looked_at_less_closely_with_a_warning),
        TEST(failures_and_cancels_leave_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
