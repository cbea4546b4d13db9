#include "osteomill/ct/itk_image.h"

#include <algorithm>

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkObject.h>

#include "osteomill/ct/captured_stderr.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

itk::ImageIOBase::Pointer reader_for(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::nrrd:
      return itk::NrrdImageIO::New().GetPointer();
    case VolumeFormat::metaimage:
      return itk::MetaImageIO::New().GetPointer();
    default:
      return itk::NiftiImageIO::New().GetPointer();
  }
}

// The library's own words: of several lines the last one says what was wrong.
std::string reason_of(const itk::ExceptionObject& error) {
  std::string text = error.GetDescription();
  text.erase(text.find_last_not_of("\n ") + 1);
  text.erase(0, text.rfind('\n') + 1);
  const std::size_t place = text.find("): ");
  if (place != std::string::npos) text.erase(0, place + 3);
  return "cannot be read: " + text;
}

void check_agreement(const std::string& path, const itk::ImageIOBase& io, const std::array<int, 3>& dims) {
  if (io.GetNumberOfComponents() != 1 || io.GetPixelType() != itk::IOPixelEnum::SCALAR) {
    throw InputError(path, "is not a grey volume: it holds several values a voxel");
  }
  if (io.GetNumberOfDimensions() < 3) throw InputError(path, "is not a volume");
  for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) {
    const auto expected = axis < 3 ? static_cast<itk::SizeValueType>(dims[axis]) : 1;
    if (io.GetDimensions(axis) != expected) throw InputError(path, "has a header that contradicts itself");
  }
}

template <typename Stored>
std::vector<float> to_float(const std::vector<char>& buffer) {
  const auto* first = reinterpret_cast<const Stored*>(buffer.data());
  std::vector<float> values(buffer.size() / sizeof(Stored));
  std::transform(first, first + values.size(), values.begin(),
                 [](Stored value) { return static_cast<float>(value); });
  return values;
}

std::vector<float> to_values(const std::string& path, const std::vector<char>& buffer,
                             itk::IOComponentEnum type) {
  using Type = itk::IOComponentEnum;
  switch (type) {
    case Type::CHAR:
      return to_float<signed char>(buffer);
    case Type::UCHAR:
      return to_float<unsigned char>(buffer);
    case Type::SHORT:
      return to_float<short>(buffer);
    case Type::USHORT:
      return to_float<unsigned short>(buffer);
    case Type::INT:
      return to_float<int>(buffer);
    case Type::UINT:
      return to_float<unsigned int>(buffer);
    case Type::LONG:
      return to_float<long>(buffer);
    case Type::ULONG:
      return to_float<unsigned long>(buffer);
    case Type::LONGLONG:
      return to_float<long long>(buffer);
    case Type::ULONGLONG:
      return to_float<unsigned long long>(buffer);
    case Type::FLOAT:
      return to_float<float>(buffer);
    case Type::DOUBLE:
      return to_float<double>(buffer);
    default:
      throw InputError(path, "has voxels of a type that is not supported");
  }
}

ItkImage read_with(itk::ImageIOBase& io, const std::string& path, const std::array<int, 3>& dims) {
  io.SetFileName(path);
  io.ReadImageInformation();
  check_agreement(path, io, dims);
  ItkImage image;
  itk::ImageIORegion region(io.GetNumberOfDimensions());
  for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) {
    region.SetSize(axis, io.GetDimensions(axis));
    if (axis > 2) continue;
    image.spacing[axis] = io.GetSpacing(axis);
    image.origin[axis] = io.GetOrigin(axis);
    const std::vector<double> direction = io.GetDirection(axis);
    std::copy_n(direction.begin(), 3, image.axes[axis].begin());
  }
  io.SetIORegion(region);
  std::vector<char> buffer(static_cast<std::size_t>(io.GetImageSizeInBytes()));
  const CapturedStderr captured;
  io.Read(buffer.data());
  // MetaIO says so there, and nowhere else, when it could not decompress, and leaves the voxels as they are.
  if (captured.text().find("failed") != std::string::npos)
    throw InputError(path, "its data cannot be decompressed");
  image.values = to_values(path, buffer, io.GetComponentType());
  return image;
}

}  // namespace

ItkImage read_itk_image(const std::string& path, VolumeFormat format, const std::array<int, 3>& dims) {
  itk::Object::GlobalWarningDisplayOff();
  const CapturedStderr captured;
  try {
    return read_with(*reader_for(format), path, dims);
  } catch (const itk::ExceptionObject& error) {
    throw InputError(path, reason_of(error));
  }
}

}  // namespace osteomill
