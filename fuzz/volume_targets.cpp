#include <array>
#include <fstream>

#include <minizip/zip.h>
#include <png.h>
#include <tiffio.h>
#include <zlib.h>

#include "osteomill/ct/read_labels.h"
#include "osteomill/ct/write_nrrd.h"

#include "fuzz/targets.h"

namespace osteomill::fuzzing {

namespace fs = std::filesystem;

namespace {

auto read_as(const std::string& name) {
  return [name](Bytes bytes, const fs::path& folder) {
    write_bytes(folder / name, bytes);
    read_as_info_does(folder / name);
  };
}

GridGeometry small_grid() {
  GridGeometry geometry;
  geometry.dims = {3, 4, 5};
  return geometry;
}

void read_label_map(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "a.seg.nrrd", bytes);
  read_labels({folder / "a.seg.nrrd", {}, {}}, small_grid(), 1 << 26);
}

std::vector<std::string> label_seeds(const fs::path&) {
  std::string voxels;
  for (int n = 0; n < 60; ++n) voxels += std::to_string(n / 12) + " ";
  std::string layers;
  for (int n = 0; n < 60; ++n) layers += n < 20 ? "1 0 " : n < 40 ? "0 1 " : "0 0 ";
  const std::string head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 4 5\nencoding: ascii\n";
  return {head + "spacings: 1 1 1\n\n" + voxels,
          head +
              "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
              "kinds: domain domain domain\nSegment0_Name:=Lower jaw\nSegment0_LabelValue:=3\n"
              "Segment0_Color:=1 0.5 0\nSegment1_Name:=Nerve\nSegment1_ID:=n\n\n" +
              voxels,
          "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 3 4 5\nencoding: ascii\nspace: LPS\n"
          "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\n"
          "Segment0_ID:=a\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment1_LabelValue:=1\n"
          "Segment1_Layer:=1\n\n" +
              layers};
}

void read_label_table_of(Bytes bytes, const fs::path& folder) {
  static const std::string map = label_seeds(folder).front();
  std::ofstream(folder / "map.nrrd") << map;
  write_bytes(folder / "a.ctbl", bytes);
  read_labels({folder / "map.nrrd", folder / "a.ctbl", {"1"}}, small_grid());
}

std::vector<std::string> label_table_seeds(const fs::path&) {
  return {
      "################\n# ITK-SnAP Label Description File\n    0     0    0    0        0  0  0    \"Clear "
      "Label\"\n"
      "   26   230  230  150        1  1  1    \"mandible left\"\n",
      "# Color table file\r\n0 Background 0 0 0 0\r\n\r\n1 left_facial nerve 10 20 30 255\n2 b 1 2 3 4\n"};
}

std::string pixels() {
  std::string bytes;
  for (int n = 0; n < 3 * 4 * 5; ++n) bytes += {static_cast<char>(7 * n), static_cast<char>(n / 20)};
  return bytes;
}

std::string deflated(const std::string& bytes) {
  std::string packed(compressBound(bytes.size()), '\0');
  uLongf size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           bytes.size());
  packed.resize(size);
  return packed;
}

std::vector<std::string> nrrd_seeds(const fs::path& folder) {
  const std::string head =
      "NRRD0005\n# made up\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: 3 4 5\n"
      "space directions: (0.5,0,0) (0,0.5,0) (0,0,1)\nspace origin: (1,2,3)\nkinds: domain domain domain\n"
      "endian: little\n";
  std::string text =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 3 4 5\nspacings: 1 1 2\nencoding: ascii\n\n";
  for (int n = 0; n < 60; ++n) text += std::to_string(n) + (n % 3 == 2 ? "\n" : " ");
  std::vector<float> densities(60, 2.5F);
  densities[7] = 1000;
  write_nrrd(folder / "a.nrrd", DensityGrid(small_grid(), densities));
  return {head + "encoding: raw\n\n" + pixels(), head + "byte skip: 4\nencoding: raw\n\n1234" + pixels(),
          text, read_bytes(folder / "a.nrrd")};
}

std::vector<std::string> metaimage_seeds(const fs::path&) {
  const auto head = [](const std::string& packing) {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" + packing +
           "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 0.5 0.5 1\nDimSize = 3 4 "
           "5\n"
           "ElementType = MET_SHORT\nElementDataFile = LOCAL\n";
  };
  const std::string packed = deflated(pixels());
  return {
      head("CompressedData = False\n") + pixels(),
      head("CompressedData = True\nCompressedDataSize = " + std::to_string(packed.size()) + "\n") + packed};
}

// Reads the bytes as a header whose voxels are in separate files, which exist.
void read_data_list(Bytes bytes, const fs::path& folder) {
  for (int n = 0; n < 5; ++n)
    std::ofstream(folder / ("s" + std::to_string(n) + ".raw")) << pixels().substr(0, 24);
  write_bytes(folder / "a.nhdr", bytes);
  read_as_info_does(folder / "a.nhdr");
}

std::vector<std::string> data_list_seeds(const fs::path&) {
  const std::string head =
      "NRRD0005\ntype: int16\ndimension: 4\nsizes: 3 4 5 1\nspacings: 0.5 0.5 1 nan\n"
      "units: \"mm\" \"mm\" \"um\" \"\"\nendian: little\nencoding: raw\ndata file: ";
  return {head + "LIST\ns0.raw\ns1.raw\ns2.raw\ns3.raw\ns4.raw\n", head + "s%d.raw 0 4 1\n"};
}

void read_pngs(Bytes bytes, const fs::path& folder) {
  fs::create_directories(folder / "pngs");
  for (const char* name : {"0.png", "1.png"}) write_bytes(folder / "pngs" / name, bytes);
  read_as_info_does(folder / "pngs", true);
}

std::vector<std::string> png_seeds(const fs::path&) {
  std::vector<std::string> seeds;
  for (const png_uint_32 format :
       std::array<png_uint_32, 3>{PNG_FORMAT_GRAY, PNG_FORMAT_RGBA, PNG_FORMAT_LINEAR_Y}) {
    png_image picture{};
    picture.version = PNG_IMAGE_VERSION;
    picture.width = 4;
    picture.height = 3;
    picture.format = format;
    const std::string values = pixels();
    std::string bytes(10'000, '\0');
    png_alloc_size_t size = bytes.size();
    png_image_write_to_memory(&picture, bytes.data(), &size, 0, values.data(), 0, nullptr);
    bytes.resize(size);
    seeds.push_back(bytes);
  }
  return seeds;
}

void read_pages(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "a.tif", bytes);
  read_as_info_does(folder / "a.tif", true);
}

std::vector<std::string> tiff_seeds(const fs::path& folder) {
  std::vector<std::string> seeds;
  for (const int packing : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE}) {
    const fs::path path = folder / "seed.tif";
    TIFF* const file = TIFFOpen(path.c_str(), "w");
    for (int page = 0; page < 2; ++page) {
      TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 4);
      TIFFSetField(file, TIFFTAG_IMAGELENGTH, 3);
      TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 16);
      TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
      TIFFSetField(file, TIFFTAG_COMPRESSION, packing);
      std::string values = pixels();
      for (std::uint32_t row = 0; row < 3; ++row) TIFFWriteScanline(file, values.data() + 8 * row, row);
      TIFFWriteDirectory(file);
    }
    TIFFClose(file);
    seeds.push_back(read_bytes(path));
  }
  return seeds;
}

// Sets the fields of a NIfTI-1 header that the reader uses.
std::vector<std::string> nifti_seeds(const fs::path& folder) {
  std::string head(352, '\0');
  const auto put = [&](std::size_t at, auto value) {
    head.replace(at, sizeof(value), reinterpret_cast<const char*>(&value), sizeof(value));
  };
  put(0, 348);
  for (const auto& [at, value] :
       {std::pair{40, 3}, {42, 3}, {44, 4}, {46, 5}, {48, 1}, {70, 4}, {72, 16}, {254, 1}})
    put(static_cast<std::size_t>(at), static_cast<std::int16_t>(value));
  for (const auto& [at, value] : {std::pair{76, 1.0F},
                                  {80, 0.5F},
                                  {84, 0.5F},
                                  {88, 1.0F},
                                  {108, 352.0F},
                                  {112, 1.0F},
                                  {280, 0.5F},
                                  {300, 0.5F},
                                  {320, 1.0F}})
    put(static_cast<std::size_t>(at), value);
  put(123, char{2});
  head.replace(344, 4, std::string("n+1\0", 4));
  const std::string sform = head + pixels();
  put(252, std::int16_t{1});
  put(254, std::int16_t{0});
  const std::string qform = head + pixels();
  const fs::path packed = folder / "a.gz";
  gzFile const file = gzopen(packed.c_str(), "wb");
  gzwrite(file, sform.data(), static_cast<unsigned>(sform.size()));
  gzclose(file);
  const std::string text = "{\"labels\": {\"jaw\": 2, \"nerve\": 3}}";
  std::string extended = head;
  const auto offset = static_cast<float>(352 + 8 + text.size());
  extended.replace(108, 4, reinterpret_cast<const char*>(&offset), 4);
  extended[348] = 1;
  const auto size = static_cast<std::int32_t>(8 + text.size());
  extended += std::string(reinterpret_cast<const char*>(&size), 4) + std::string(4, '\0') + text + pixels();
  return {sform, qform, read_bytes(packed), extended};
}

std::vector<std::string> zip_seeds(const fs::path& folder) {
  const fs::path path = folder / "a.zip";
  zipFile const zip = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"case/a.nrrd", nrrd_seeds(folder).front()},
        {"case/notes.txt", "notes"}}) {
    const zip_fileinfo info{};
    zipOpenNewFileInZip(zip, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, 9);
    zipWriteInFileInZip(zip, bytes.data(), static_cast<unsigned>(bytes.size()));
    zipCloseFileInZip(zip);
  }
  zipClose(zip, nullptr);
  return {read_bytes(path)};
}

}  // namespace

std::vector<Target> volume_targets() {
  return {{"nrrd", read_as("a.nrrd"), nrrd_seeds},
          {"metaimage", read_as("a.mha"), metaimage_seeds},
          {"nifti", read_as("a.nii.gz"), nifti_seeds},
          {"zip", read_as("a.zip"), zip_seeds},
          {"labels", read_label_map, label_seeds},
          {"label-table", read_label_table_of, label_table_seeds},
          {"nrrd-list", read_data_list, data_list_seeds},
          {"png", read_pngs, png_seeds},
          {"tiff", read_pages, tiff_seeds}};
}

}  // namespace osteomill::fuzzing
