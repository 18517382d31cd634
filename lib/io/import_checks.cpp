// SPDX-License-Identifier: MIT
#include "import_checks.hpp"

#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace pvt
{

namespace
{

using std::size_t;
using std::string;
using std::string_view;

constexpr string_view kBlank = " \t\r\v\f";

[[noreturn]] void Refuse(const string& reason)
{
    throw std::runtime_error(reason);
}

// Takes the next line off `text`, without its end.
string_view TakeLine(string_view& text)
{
    const size_t end = text.find('\n');
    const string_view line = text.substr(0, end);
    text.remove_prefix(end == string_view::npos ? text.size() : end + 1);
    return line;
}

// Takes the next word off `line`; empty at its end.
string_view TakeWord(string_view& line)
{
    const size_t begin = line.find_first_not_of(kBlank);
    if (begin == string_view::npos) {
        line = {};
        return {};
    }
    line.remove_prefix(begin);
    const size_t end = line.find_first_of(kBlank);
    const string_view word = line.substr(0, end);
    line.remove_prefix(word.size());
    return word;
}

bool IsBlank(string_view line)
{
    return line.find_first_not_of(kBlank) == string_view::npos;
}

template <class T> bool ParseInteger(string_view word, T& value)
{
    const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
    return parsed.ec == std::errc();
}

// A statement of OBJ, which may go on in the next line behind a backslash.
class ObjLines
{
  public:
    explicit ObjLines(string_view text) : text_(text)
    {
    }
    bool Next(string& statement)
    {
        if (text_.empty()) {
            return false;
        }
        begin_ = end_ + 1;
        statement.clear();
        bool more = true;
        while (more && !text_.empty()) {
            string_view line = TakeLine(text_);
            ++end_;
            const size_t last = line.find_last_not_of(kBlank);
            more = last != string_view::npos && line[last] == '\\';
            statement.append(more ? line.substr(0, last) : line).push_back(' ');
        }
        return true;
    }
    size_t Number() const
    {
        return begin_;
    }

  private:
    string_view text_;
    size_t begin_ = 0, end_ = 0;
};

// The largest index of all faces, and where it stands: positions may follow the faces.
struct LargestIndex {
    std::int64_t value = 0;
    size_t line = 0;
};

void CheckFace(string_view words, size_t line, std::int64_t positionCount, LargestIndex& largest)
{
    for (string_view word = TakeWord(words); !word.empty(); word = TakeWord(words)) {
        std::int64_t index = 0;
        if (word[0] == '#') {
            return;
        }
        if (!ParseInteger(word, index)) {
            Refuse("line " + std::to_string(line) + ": \"" + string(word.substr(0, 40)) +
                   "\" is no index of a face");
        }
        if (index == 0 || index < -positionCount) {
            Refuse("line " + std::to_string(line) + ": a face has index " + std::to_string(index) +
                   ", but there are " + std::to_string(positionCount) +
                   " positions before it, counted from 1");
        }
        if (index > largest.value) {
            largest = {index, line};
        }
    }
}

} // namespace

void CheckObj(string_view text)
{
    ObjLines lines(text);
    LargestIndex largest;
    std::int64_t positionCount = 0;
    string statement;
    while (lines.Next(statement)) {
        string_view words = statement;
        const string_view keyword = TakeWord(words);
        if (keyword == "v") {
            ++positionCount;
        } else if (keyword == "f") {
            CheckFace(words, lines.Number(), positionCount, largest);
        }
    }
    if (largest.value > positionCount) {
        Refuse("line " + std::to_string(largest.line) + ": a face has index " +
               std::to_string(largest.value) + ", but there are only " +
               std::to_string(positionCount) + " positions");
    }
    if (positionCount == 0) {
        Refuse("there is no position (no line begins with \"v\")");
    }
}

namespace
{

struct PlyProperty {
    size_t size = 0;      // [bytes] of a value
    size_t countSize = 0; // [bytes] of a list's count; 0: no list
};

struct PlyElement {
    string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    string format;
    std::vector<PlyElement> elements;
    string_view data;
};

size_t GetPlySize(string_view type)
{
    static constexpr struct {
        string_view name;
        size_t size;
    } types[] = {{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},
                 {"short", 2}, {"ushort", 2},  {"int16", 2},  {"uint16", 2},
                 {"int", 4},   {"uint", 4},    {"int32", 4},  {"uint32", 4},
                 {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
    for (const auto& each : types) {
        if (each.name == type) {
            return each.size;
        }
    }
    Refuse("the PLY header has the unknown type \"" + string(type.substr(0, 40)) + "\"");
}

void ParsePlyProperty(string_view words, PlyHeader& header)
{
    if (header.elements.empty()) {
        Refuse("the PLY header has a property before any element");
    }
    PlyProperty property;
    string_view type = TakeWord(words);
    if (type == "list") {
        property.countSize = GetPlySize(TakeWord(words));
        type = TakeWord(words);
    }
    property.size = GetPlySize(type);
    header.elements.back().properties.push_back(property);
}

void ParsePlyElement(string_view words, PlyHeader& header)
{
    PlyElement element;
    element.name = TakeWord(words);
    const string_view count = TakeWord(words);
    if (!ParseInteger(count, element.count)) {
        Refuse("the PLY header counts \"" + string(count.substr(0, 40)) + "\" elements of \"" +
               element.name.substr(0, 40) + "\"");
    }
    header.elements.push_back(std::move(element));
}

PlyHeader ParsePlyHeader(string_view bytes)
{
    PlyHeader header;
    header.data = bytes;
    const string_view magic = TakeLine(header.data);
    if (magic.substr(0, 3) != "ply" && magic.substr(0, 3) != "PLY") {
        Refuse("it does not begin with \"ply\"");
    }
    while (!header.data.empty()) {
        string_view words = TakeLine(header.data);
        const string_view keyword = TakeWord(words);
        if (keyword == "end_header") {
            return header;
        }
        if (keyword == "format") {
            header.format = TakeWord(words);
        } else if (keyword == "element") {
            ParsePlyElement(words, header);
        } else if (keyword == "property") {
            ParsePlyProperty(words, header);
        }
    }
    Refuse("the PLY header has no end_header; the file was cut short");
}

[[noreturn]] void RefuseShort(const PlyElement& element, std::uint64_t found)
{
    Refuse("the header promises " + std::to_string(element.count) + " elements of \"" +
           element.name.substr(0, 40) + "\", but the file ends after " + std::to_string(found) +
           "; it was cut short");
}

void CheckPlyLines(const PlyHeader& header)
{
    string_view text = header.data;
    for (const PlyElement& element : header.elements) {
        for (std::uint64_t i = 0; i < element.count;) {
            if (text.empty()) {
                RefuseShort(element, i);
            }
            i += IsBlank(TakeLine(text)) ? 0 : 1;
        }
    }
}

std::uint64_t ReadPlyCount(const char* bytes, size_t size, bool big)
{
    std::uint64_t value = 0;
    for (size_t i = 0; i < size; ++i) {
        const auto byte = static_cast<unsigned char>(bytes[big ? i : size - 1 - i]);
        value = value << 8 | byte;
    }
    return value;
}

// The bytes of one element at the begin of `data`; more than there are when it is cut short.
size_t MeasurePlyElement(const PlyElement& element, string_view data, bool big)
{
    size_t at = 0;
    for (const PlyProperty& property : element.properties) {
        std::uint64_t count = 1;
        if (property.countSize != 0) {
            if (property.countSize > data.size() - at) {
                return data.size() + 1;
            }
            count = ReadPlyCount(data.data() + at, property.countSize, big);
            at += property.countSize;
        }
        if (count > (data.size() - at) / property.size) {
            return data.size() + 1;
        }
        at += static_cast<size_t>(count) * property.size;
    }
    return at;
}

void CheckPlyBytes(const PlyHeader& header)
{
    const bool big = header.format == "binary_big_endian";
    string_view data = header.data;
    for (const PlyElement& element : header.elements) {
        if (element.properties.empty()) {
            continue;
        }
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const size_t size = MeasurePlyElement(element, data, big);
            if (size > data.size()) {
                RefuseShort(element, i);
            }
            data.remove_prefix(size);
        }
    }
}

} // namespace

void CheckPly(string_view bytes)
{
    const PlyHeader header = ParsePlyHeader(bytes);
    if (header.format == "ascii") {
        CheckPlyLines(header);
    } else if (header.format == "binary_little_endian" || header.format == "binary_big_endian") {
        CheckPlyBytes(header);
    } else {
        Refuse("the PLY header has the unknown format \"" + header.format.substr(0, 40) + "\"");
    }
}

// In case that the header's lines end in \r\n, assimp leaves out a \n at the begin of the data,
// which may as well be the first byte of a coordinate. With such a line end both are right.
string EndPlyHeader(string_view bytes)
{
    const PlyHeader header = ParsePlyHeader(bytes);
    const size_t data = bytes.size() - header.data.size();
    const bool isLeftOut = header.format != "ascii" && header.data.substr(0, 1) == "\n" &&
                           bytes.substr(data - 2, 1) != "\r";
    return isLeftOut ? string(bytes.substr(0, data - 1)) + "\r\n" + string(header.data) : string();
}

void CheckStl(string_view bytes)
{
    constexpr size_t headerSize = 84, triangleSize = 50, window = 512;
    std::uint64_t count = 0;
    if (bytes.size() >= headerSize) {
        count = ReadPlyCount(bytes.data() + 80, 4, false);
        if (bytes.size() == headerSize + triangleSize * count) {
            return;
        }
    }
    const size_t begin = bytes.find_first_not_of(" \t\r\n");
    const bool isText = begin != string_view::npos && bytes.substr(begin, 5) == "solid" &&
                        bytes.substr(0, window).find('\0') == string_view::npos;
    if (isText) {
        if (bytes.rfind("endsolid") == string_view::npos) {
            Refuse("the STL text has no endsolid; it was cut short");
        }
        return;
    }
    if (bytes.size() < headerSize) {
        Refuse("it has only " + std::to_string(bytes.size()) +
               " bytes, which is too few for an STL");
    }
    Refuse("its header says " + std::to_string(count) + " triangles, which makes " +
           std::to_string(headerSize + triangleSize * count) + " bytes, but the file has " +
           std::to_string(bytes.size()));
}

} // namespace pvt
