// SPDX-License-Identifier: MIT
// What assimp does not tell, or does not survive: files that were cut short or promise more than
// they hold. Each check throws std::runtime_error with the place and the reason.
#ifndef PVT_IO_IMPORT_CHECKS_HPP
#define PVT_IO_IMPORT_CHECKS_HPP

#include <string>
#include <string_view>

namespace pvt
{

/// Whether every index of a face has its position. Lines are counted from 1.
void CheckObj(std::string_view text);
/// Whether the elements that the header promises are there.
void CheckPly(std::string_view bytes);
/// What assimp is to read instead, where it would take the first byte of the data for the end of
/// the header; empty where the bytes do as they are. They have passed the check.
std::string EndPlyHeader(std::string_view bytes);
/// Whether the size fits the number of triangles, or the text has an end.
void CheckStl(std::string_view bytes);

} // namespace pvt

#endif
