#pragma once

#include <filesystem>

#include "osteomill/visual/brick_mesh.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// The formats of files of triangles that write_mesh() writes: binary STL; PLY, binary and little endian,
/// with normals and densities; OBJ with normals. All in W (the patient's LPS frame, mm), which STL and the
/// comments of the others say as "SPACE=LPS".
enum class MeshFormat : unsigned char { stl, ply, obj };

/// Returns the format by the file name's extension, in capitals or not. Throws InputError if it is none of
/// these.
MeshFormat mesh_format_of(const std::filesystem::path& path);

/// Returns whether files of this format hold a colour for each vertex.
bool holds_colours(MeshFormat format);

/// Writes the mesh. With `labels`, those of the bone, each vertex has the colour of the label under it, or
/// that of bone: in PLY as red, green, blue beside the label's value as it stands in the map (0 for none), in
/// OBJ as three numbers from 0 to 1 behind its place, as most programs take them; STL has no room for it.
/// Appears whole or not at all; throws InputError, naming the file, if it cannot be written.
void write_mesh(const std::filesystem::path& path, const BrickMesh& mesh, const LabelMap* labels = nullptr);

}  // namespace osteomill
