// SPDX-License-Identifier: MIT
// URIs: glTF 2.0, sections 2.8 and 3.6.1.1; RFC 2397 and RFC 3986.
#include "gltf_uri.hpp"

namespace pvt
{

namespace
{

constexpr std::size_t kPollBytes = 1 << 20;

int GetBase64Value(char c)
{
    if (c >= 'A' && c <= 'Z') {
        return c - 'A';
    }
    if (c >= 'a' && c <= 'z') {
        return c - 'a' + 26;
    }
    if (c >= '0' && c <= '9') {
        return c - '0' + 52;
    }
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

int GetHexValue(char c)
{
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    const char lower = static_cast<char>(c | 0x20);
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

// "http:", "file:" and their like: a letter, then letters, digits, plus, minus or dots.
bool HasScheme(const std::string& uri)
{
    const std::size_t colon = uri.find_first_of(":/?#");
    return colon != std::string::npos && colon > 0 && uri[colon] == ':';
}

// The path that a relative reference names (RFC 3986, section 2.1). A percent sign that begins no
// two digits stays as it is.
std::string DecodePercent(const std::string& uri)
{
    std::string path;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const int high = uri[i] == '%' && i + 2 < uri.size() ? GetHexValue(uri[i + 1]) : -1;
        const int low = high >= 0 ? GetHexValue(uri[i + 2]) : -1;
        if (low >= 0) {
            path.push_back(static_cast<char>(16 * high + low));
            i += 2;
        } else {
            path.push_back(uri[i]);
        }
    }
    return path;
}

} // namespace

bool IsDataUri(const std::string& uri)
{
    return uri.compare(0, 5, "data:") == 0;
}

Span DecodeDataUri(const pvtLoadJob& job, const std::string& uri, const std::string& place,
                   Array<std::uint8_t>& bytes)
{
    static const char marker[] = ";base64,";
    const std::size_t comma = uri.find(',');
    const std::size_t begin = comma == std::string::npos ? 0 : comma + 1;
    const std::size_t length = sizeof marker - 1;
    if (begin < length || uri.compare(begin - length, length, marker) != 0) {
        Refuse(job, "%s.uri is a data URI, but not in base64", place.c_str());
    }
    std::size_t end = uri.size();
    while (end > begin && uri[end - 1] == '=') {
        --end;
    }
    bytes.Resize((end - begin) / 4 * 3 + 3);
    std::size_t size = 0;
    std::uint32_t bits = 0;
    for (std::size_t i = begin; i < end; ++i) {
        const int value = GetBase64Value(uri[i]);
        if (value < 0) {
            Refuse(job, "%s.uri: character %zu is not base64", place.c_str(), i);
        }
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        // Four characters are three bytes: each but the first completes one.
        const unsigned phase = static_cast<unsigned>((i - begin) & 3);
        if (phase != 0) {
            bytes[size++] = static_cast<std::uint8_t>(bits >> (6 - 2 * phase));
        }
        if (i % kPollBytes == 0) {
            Poll(job.context);
        }
    }
    return {bytes.Data(), size};
}

Span ReadUri(const pvtLoadJob& job, const std::string& uri, const std::string& place,
             OwnedSource& file)
{
    if (HasScheme(uri)) {
        Refuse(job, "%s.uri \"%s\" is not a file beside the model; nothing is fetched",
               place.c_str(), Clean(uri).c_str());
    }
    const std::string name = DecodePercent(uri);
    if (name.empty() || name.find('\0') != std::string::npos) {
        Refuse(job, "%s.uri \"%s\" is not the name of a file", place.c_str(), Clean(uri).c_str());
    }
    const pvtStatus status = pvtReadSourceBeside(job.context, job.path, name.c_str(),
                                                 job.options->maxBytes, &file.source);
    if (status != PVT_OK) {
        const std::string reason = pvtContext_GetMessage(job.context);
        Refuse(job, status, "%s: %s", place.c_str(), reason.c_str());
    }
    return {file.source.bytes, file.source.size};
}

} // namespace pvt
