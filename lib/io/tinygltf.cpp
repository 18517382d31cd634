// SPDX-License-Identifier: MIT
// tinygltf's implementation, compiled here without its decoders and without its file access.
#include <fstream>
#include <sstream>

#define TINYGLTF_IMPLEMENTATION
#include "tinygltf.hpp"
