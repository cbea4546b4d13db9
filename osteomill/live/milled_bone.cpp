#include "osteomill/live/milled_bone.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <limits>
#include <system_error>

#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "bricks are written as they lie in memory");

constexpr const char* kFirstLine = "osteomill milled bone 2";
constexpr std::size_t kBrickBytes = 3 * sizeof(std::int32_t) + sizeof(DensityBlock::densities);

template <typename Value>
void put(std::ostream& out, const Value& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof(value));
}

template <typename Value>
void get(std::istream& in, Value& value) {
  in.read(reinterpret_cast<char*>(&value), sizeof(value));
}

bool has_label(std::istream& in, const char* label) {
  std::string word;
  return in >> word && word == label;
}

// As many texts as a number before them says.
bool read_texts(std::istream& in, std::vector<std::string>& texts) {
  std::size_t count = 0;
  std::string text;
  if (!(in >> count)) return false;
  while (texts.size() < count && in >> std::quoted(text)) texts.push_back(text);
  return texts.size() == count;
}

struct Facts {
  MilledBone milled;
  std::size_t bricks = 0;
};

Facts read_facts(std::istream& in, const fs::path& path) {
  std::string first;
  if (!std::getline(in, first) || first != kFirstLine) {
    throw InputError(path.string(), "is no milled bone of this version");
  }
  Facts facts;
  MilledBone& milled = facts.milled;
  bool ok = has_label(in, "scan") && in >> std::quoted(milled.scan);
  ok = ok && has_label(in, "series") && in >> std::quoted(milled.series);
  ok = ok && has_label(in, "labels") && in >> std::quoted(milled.labels);
  ok = ok && has_label(in, "label_table") && in >> std::quoted(milled.label_table);
  ok = ok && has_label(in, "no_go") && read_texts(in, milled.no_go);
  ok = ok && has_label(in, "name") && in >> std::quoted(milled.name);
  ok = ok && has_label(in, "isovalue") && in >> milled.isovalue;
  ok = ok && has_label(in, "removed_mm3") && in >> milled.removed_mm3;
  ok = ok && has_label(in, "dims") && in >> milled.dims[0] >> milled.dims[1] >> milled.dims[2];
  ok = ok && has_label(in, "fingerprint") && in >> milled.fingerprint;
  ok = ok && has_label(in, "bricks") && in >> facts.bricks;
  ok = ok && in.get() == '\n' && std::isfinite(milled.isovalue) && std::isfinite(milled.removed_mm3);
  if (!ok) throw InputError(path.string(), "is damaged: its facts cannot be read");
  return facts;
}

bool lies_in(const std::array<int, 3>& dims, const VoxelIndex& first) {
  const std::array<int, 3> v{first.i, first.j, first.k};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (v[axis] < 0 || v[axis] >= dims[axis] || v[axis] % DensityBlock::kVoxels != 0) return false;
  }
  return true;
}

DensityBlock read_brick(std::istream& in, const MilledBone& milled, const fs::path& path) {
  std::array<std::int32_t, 3> first{};
  DensityBlock brick;
  get(in, first);
  get(in, brick.densities);
  brick.first = {first[0], first[1], first[2]};
  const bool finite = std::all_of(brick.densities.begin(), brick.densities.end(),
                                  [](float density) { return std::isfinite(density); });
  if (!in || !finite || !lies_in(milled.dims, brick.first)) {
    throw InputError(path.string(), "is damaged: a brick cannot be read");
  }
  return brick;
}

std::ifstream opened(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string(), "cannot be read");
  return in;
}

}  // namespace

void require_same_scan(const MilledBone& milled, const MilledBone& read) {
  if (milled.dims == read.dims && milled.fingerprint == read.fingerprint) return;
  throw InputError(read.name, "has changed since it was milled, so what was milled cannot be put into it");
}

void write_milled_bone(const fs::path& path, const MilledBone& milled) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << kFirstLine << std::setprecision(std::numeric_limits<double>::max_digits10) << "\nscan "
        << std::quoted(milled.scan) << "\nseries " << std::quoted(milled.series) << "\nlabels "
        << std::quoted(milled.labels) << "\nlabel_table " << std::quoted(milled.label_table) << "\nno_go "
        << milled.no_go.size();
    for (const std::string& label : milled.no_go) out << ' ' << std::quoted(label);
    out << "\nname " << std::quoted(milled.name) << "\nisovalue " << milled.isovalue << "\nremoved_mm3 "
        << milled.removed_mm3 << "\ndims " << milled.dims[0] << ' ' << milled.dims[1] << ' ' << milled.dims[2]
        << "\nfingerprint " << milled.fingerprint << "\nbricks " << milled.bricks.size() << '\n';
    for (const DensityBlock& brick : milled.bricks) {
      put(out, std::array<std::int32_t, 3>{brick.first.i, brick.first.j, brick.first.k});
      put(out, brick.densities);
    }
  });
}

MilledBone read_milled_bone(const fs::path& path) {
  std::ifstream in = opened(path);
  auto [milled, bricks] = read_facts(in, path);
  std::error_code error;
  const auto bytes = fs::file_size(path, error) - static_cast<std::uintmax_t>(in.tellg());
  if (error || bytes % kBrickBytes != 0 || bytes / kBrickBytes != bricks) {
    throw InputError(path.string(), "is damaged: it does not have the length that it says");
  }
  milled.bricks.reserve(bricks);
  for (std::size_t n = 0; n < bricks; ++n) milled.bricks.push_back(read_brick(in, milled, path));
  return milled;
}

MilledBone read_milled_bone_facts(const fs::path& path) {
  std::ifstream in = opened(path);
  return read_facts(in, path).milled;
}

}  // namespace osteomill
