#pragma once

#include <filesystem>

#include "osteomill/surface/brick_mesh.h"

namespace osteomill {

/// Files of triangles: binary STL; PLY, binary and little endian, with normals and densities; OBJ with
/// normals. All in W (the patient's LPS frame, mm), which STL and the comments of the others say as
/// "SPACE=LPS".
enum class MeshFormat : unsigned char { stl, ply, obj };

/// By the file name's extension, in capitals or not. Throws InputError where it is none of these.
MeshFormat mesh_format_of(const std::filesystem::path& path);

/// Writes the mesh. Appears whole or not at all; throws InputError, naming the file, where it cannot be
/// written.
void write_mesh(const std::filesystem::path& path, const BrickMesh& mesh);

}  // namespace osteomill
