#include "osteomill/ct/dicom_elements.h"

#include <array>
#include <cctype>
#include <fstream>
#include <sstream>

#include "osteomill/ct/dicom_parser.h"
#include "osteomill/ct/inflate.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Images come down to a tenth or so; what would grow more than this is damaged or meant to fill the memory.
constexpr std::uint64_t kMostInflation = 100;

DicomEncoding encoding_of(const std::string& transfer_syntax) {
  if (transfer_syntax == "1.2.840.10008.1.2") return {.implicit = true};
  if (transfer_syntax == "1.2.840.10008.1.2.2") return {.big_endian = true};
  return {};
}

bool is_deflated(const DicomFile& file) {
  return file.transfer_syntax == "1.2.840.10008.1.2.1.99";
}

// Where the elements begin, or nothing where this is not DICOM. Old files have no preamble and begin with an
// element of group 2 or 8 at once.
std::optional<std::uint64_t> start_of_elements(std::istream& in) {
  std::string head(132, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  in.clear();
  if (head.size() == 132 && head.ends_with("DICM")) return 132;
  if (head.size() >= 8 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0) return 0;
  return std::nullopt;
}

std::string inflate_rest(std::istream& in, std::uint64_t size) {
  std::string deflated(size, '\0');
  in.read(deflated.data(), static_cast<std::streamsize>(deflated.size()));
  const std::optional<std::string> inflated = inflate_raw(deflated, kMostInflation * deflated.size());
  if (!inflated) throw DicomFault{"is cut short or damaged: its deflated data do not inflate"};
  return *inflated;
}

void read_file(std::istream& in, std::uint64_t size, std::uint64_t start, DicomFile& file) {
  DicomParser parser(in, size, file);
  parser.seek(start);
  parser.read_meta();
  if (is_deflated(file)) {
    const std::string inflated = inflate_rest(in, size - parser.position());
    std::istringstream inner(inflated);
    DicomParser(inner, inflated.size(), file).read_data_set({});
    return;
  }
  DicomEncoding encoding = encoding_of(file.transfer_syntax);
  if (file.transfer_syntax.empty() && size - parser.position() >= 8) {
    // Without a transfer syntax only the look of the first element tells.
    std::array<char, 6> first{};
    in.read(first.data(), first.size());
    parser.seek(parser.position());
    encoding.implicit = !std::isupper(static_cast<unsigned char>(first[4]));
  }
  file.big_endian = encoding.big_endian;
  parser.read_data_set(encoding);
}

std::ifstream open_file(const fs::path& path, std::uint64_t& size) {
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  size = fs::file_size(path, error);
  if (!in || error) throw InputError(path.string(), "cannot be read");
  return in;
}

}  // namespace

std::optional<DicomFile> read_dicom_elements(const fs::path& path) {
  std::uint64_t size = 0;
  std::ifstream in = open_file(path, size);
  const std::optional<std::uint64_t> start = start_of_elements(in);
  if (!start) return std::nullopt;
  DicomFile file;
  try {
    read_file(in, size, *start, file);
  } catch (const DicomFault& fault) {
    file.fault = fault.reason;
  }
  return file;
}

std::unique_ptr<std::istream> open_dicom_data(const fs::path& path) {
  std::uint64_t size = 0;
  auto in = std::make_unique<std::ifstream>(open_file(path, size));
  DicomFile file;
  try {
    DicomParser parser(*in, size, file);
    parser.seek(start_of_elements(*in).value_or(0));
    parser.read_meta();
    if (is_deflated(file))
      return std::make_unique<std::istringstream>(inflate_rest(*in, size - parser.position()));
  } catch (const DicomFault& fault) {
    throw InputError(path.string(), fault.reason);
  }
  in->seekg(0);
  return in;
}

}  // namespace osteomill
