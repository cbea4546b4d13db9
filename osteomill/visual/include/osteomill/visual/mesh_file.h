#pragma once

#include <filesystem>

#include "osteomill/visual/brick_mesh.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Formats of write_mesh(): binary STL; PLY, binary little endian, with normals and densities; OBJ with
/// normals. All in W (the patient's LPS frame, mm), stated as "SPACE=LPS" in the STL header or the comments
/// of the others.
enum class MeshFormat : unsigned char { stl, ply, obj };

/// Returns the format for a file name's extension, ignoring case. Throws InputError for any other extension.
MeshFormat mesh_format_of(const std::filesystem::path& path);

/// Returns whether this format stores a colour per vertex.
bool has_vertex_colours(MeshFormat format);

/// Writes the mesh atomically. With the bone's `labels`, each vertex has the colour of the label under it, or
/// else of bone: in PLY as red, green, blue, followed by the label's value in the map (0 for none); in OBJ as
/// three numbers from 0 to 1 after the position, as most programs read them; STL stores no colours. Throws
/// InputError, naming the file, if it cannot be written.
void write_mesh(const std::filesystem::path& path, const BrickMesh& mesh, const LabelMap* labels = nullptr);

}  // namespace osteomill
