// SPDX-License-Identifier: MIT
// The shape of a glTF document: types, ranges, and references to what is there.
#ifndef PVT_IO_GLTF_SCHEMA_HPP
#define PVT_IO_GLTF_SCHEMA_HPP

#include "edge.hpp"

#include <nlohmann/json.hpp>

namespace pvt
{

using Json = nlohmann::json;

/// Refuses a document in which anything that this room uses has another type, lies outside of its
/// range, or refers to what is not there; the text names the place. Numbers like 3.0 where an
/// integer is asked for become integers. Extensions that are required and not known here are
/// PVT_UNSUPPORTED.
void CheckGltfSchema(const pvtLoadJob& job, Json& document);

/// How many elements the document's array of that name has; 0 when there is none.
std::size_t GetCount(const Json& document, const char* name);
/// Whether extensionsUsed or extensionsRequired, as `list` says, names the extension.
bool IsExtensionListed(const Json& document, const char* list, const char* name);

/// An extension's object on `owner`; null when there is none.
const Json* FindExtension(const Json& owner, const char* name);

} // namespace pvt

#endif
