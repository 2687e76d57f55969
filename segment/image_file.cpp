// The one file that knows ITK.
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkImageSeriesReader.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/errors.hpp"
#include "core/log.hpp"
#include "image.hpp"

namespace valsalva::segment {
namespace {

namespace fs = std::filesystem;
using Volume = itk::Image<float, 3>;

constexpr double most_uneven_mm = 0.05;  // between the slices of a series; positions are rounded on export

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

itk::ImageIOBase::Pointer format_of(const fs::path& path) {
  const std::string name = path.filename().string();
  if (ends_with(name, ".nii") || ends_with(name, ".nii.gz")) return itk::NiftiImageIO::New().GetPointer();
  if (ends_with(name, ".nrrd") || ends_with(name, ".nhdr")) return itk::NrrdImageIO::New().GetPointer();
  if (ends_with(name, ".mha") || ends_with(name, ".mhd")) return itk::MetaImageIO::New().GetPointer();
  throw InputError(
      "{}: the ending is none that is known for an image; expected .nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd, "
      "or "
      "a folder with a DICOM series",
      path.string());
}

/// Bytes of a file, unpacked where it is gzipped. What ITK's readers do with a short file is to leave zeros.
std::uintmax_t unpacked_size(const fs::path& path) {
  gzFile file = gzopen(path.c_str(), "rb");
  if (!file) throw InputError("{}: cannot be opened; check its permissions", path.string());
  std::vector<char> buffer(1 << 20);
  std::uintmax_t total = 0;
  int got = 0;
  while ((got = gzread(file, buffer.data(), unsigned(buffer.size()))) > 0) total += std::uintmax_t(got);
  int code = Z_OK;
  gzerror(file, &code);
  gzclose(file);
  if (got < 0 || (code != Z_OK && code != Z_STREAM_END))
    throw InputError("{}: is damaged or cut short", path.string());
  return total;
}

/// The bytes that a MetaImage header announces and the file holds behind it.
void check_meta_image(const fs::path& path, std::uintmax_t expected) {
  std::ifstream file(path, std::ios::binary);
  fs::path data = path;
  std::uintmax_t offset = 0;
  for (std::string line; std::getline(file, line);) {
    const std::size_t equals = line.find('=');
    const std::string value =
        equals == std::string::npos ? "" : line.substr(line.find_first_not_of(" ", equals + 1));
    if (line.starts_with("CompressedDataSize")) expected = std::stoull(value);
    if (line.starts_with("ElementDataFile")) {
      if (value.starts_with("LOCAL"))
        offset = std::uintmax_t(file.tellg());
      else
        data = path.parent_path() / value;
      break;
    }
  }
  if (!fs::exists(data)) throw InputError("{}: its data file {} is missing", path.string(), data.string());
  if (fs::file_size(data) < offset + expected)
    throw InputError("{}: is cut short: {} bytes of data, expected {}", data.string(),
                     fs::file_size(data) - offset, expected);
}

void check_complete(const fs::path& path, std::uintmax_t expected) {
  const std::string name = path.filename().string();
  if (ends_with(name, ".mha") || ends_with(name, ".mhd")) check_meta_image(path, expected);
  if (ends_with(name, ".nii") || ends_with(name, ".nii.gz"))
    if (const std::uintmax_t found = unpacked_size(path); found < expected + 348)
      throw InputError("{}: is cut short: {} bytes of data, expected {}", path.string(), found,
                       expected + 348);
}

Volume::Pointer read_file(const fs::path& path) {
  const auto format = format_of(path);
  format->SetFileName(path.string());
  format->ReadImageInformation();
  unsigned real_dimensions = 0;
  for (unsigned d = 0; d < format->GetNumberOfDimensions(); ++d)
    real_dimensions += format->GetDimensions(d) > 1;
  if (real_dimensions != 3 || format->GetNumberOfComponents() != 1)
    throw InputError(
        "{}: has {} dimensions and {} values a voxel; expected one scalar volume (pick one phase)",
        path.string(), real_dimensions, format->GetNumberOfComponents());
  for (unsigned d = 0; d < 3; ++d)
    if (!(format->GetSpacing(d) > 0))
      throw InputError("{}: spacing {} mm along axis {}; expected a positive one, correct the header",
                       path.string(), format->GetSpacing(d), d);
  check_complete(path, std::uintmax_t(format->GetImageSizeInBytes()));
  const auto reader = itk::ImageFileReader<Volume>::New();
  reader->SetImageIO(format);
  reader->SetFileName(path.string());
  reader->Update();
  return reader->GetOutput();
}

/// What the header of one DICOM slice says.
struct Slice {
  std::string file;
  std::array<itk::SizeValueType, 2> size;
  Vec3 position, normal;  // LPS, mm
};

Slice slice_of(const std::string& file) {
  const auto header = itk::GDCMImageIO::New();
  header->SetFileName(file);
  header->ReadImageInformation();
  Slice slice{file, {header->GetDimensions(0), header->GetDimensions(1)}, {}, {}};
  const auto along = [&](unsigned axis) {
    const std::vector<double> d = header->GetDirection(axis);
    return Vec3(d[0], d[1], d[2]);
  };
  for (unsigned d = 0; d < 3; ++d) slice.position[d] = header->GetOrigin(d);
  slice.normal = along(0).cross(along(1)).normalized();
  return slice;
}

/// Slices of one size and direction, in equal steps: what is one volume.
void check_stack(const fs::path& folder, const std::vector<Slice>& slices) {
  const Slice& first = slices.front();
  std::vector<double> steps;
  for (std::size_t n = 0; n < slices.size(); ++n) {
    const Slice& here = slices[n];
    if (here.size != first.size)
      throw InputError(
          "{}: slices of {} x {} and of {} x {} pixels ({}) in one series; keep those of one size",
          folder.string(), first.size[0], first.size[1], here.size[0], here.size[1], here.file);
    if (here.normal.dot(first.normal) < 1 - 1e-4)
      throw InputError("{}: {} is turned against the other slices of its series; remove scout images",
                       folder.string(), here.file);
    if (n > 0) steps.push_back((here.position - slices[n - 1].position).dot(first.normal));
  }
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double usual = sorted[sorted.size() / 2];
  for (std::size_t n = 0; n < steps.size(); ++n) {
    if (std::abs(steps[n]) < most_uneven_mm)
      throw InputError("{}: {} and {} lie in one place; the series holds several phases, keep one",
                       folder.string(), slices[n].file, slices[n + 1].file);
    if (std::abs(steps[n] - usual) > most_uneven_mm)
      throw InputError(
          "{}: {:.3f} mm between the slices {} and {}, expected {:.3f} mm as between the others; a slice is "
          "missing, export the series again",
          folder.string(), steps[n], slices[n].file, slices[n + 1].file, usual);
  }
}

Volume::Pointer read_series(const fs::path& folder) {
  const auto names = itk::GDCMSeriesFileNames::New();
  names->SetUseSeriesDetails(false);  // a series is what has one series number, so that odd slices are seen
  names->SetDirectory(folder.string());
  std::vector<std::string> longest;
  std::string chosen, counts;
  for (const std::string& series : names->GetSeriesUIDs()) {
    const auto& files = names->GetFileNames(series);
    counts += fmt::format("{}{} ({} slices)", counts.empty() ? "" : ", ", series, files.size());
    if (files.size() <= longest.size()) continue;
    longest.assign(files.begin(), files.end());
    chosen = series;
  }
  if (longest.size() < 2)
    throw InputError("{}: the folder holds no DICOM series of two or more slices{}", folder.string(),
                     counts.empty() ? "" : "; found " + counts);
  if (names->GetSeriesUIDs().size() > 1)
    log::warn("{}: several DICOM series, {}; {} is taken, the one with the most slices", folder.string(),
              counts, chosen);
  std::vector<Slice> slices;
  for (const std::string& file : longest) slices.push_back(slice_of(file));
  const Vec3 normal = slices.front().normal;
  std::stable_sort(slices.begin(), slices.end(), [&](const Slice& a, const Slice& b) {
    return a.position.dot(normal) < b.position.dot(normal);
  });
  check_stack(folder, slices);
  for (std::size_t n = 0; n < slices.size(); ++n) longest[n] = slices[n].file;
  const auto reader = itk::ImageSeriesReader<Volume>::New();
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(longest);
  reader->ForceOrthogonalDirectionOff();  // a tilted gantry shears the volume
  reader->Update();
  return reader->GetOutput();
}

}  // namespace

Image read_image(const fs::path& path) {
  if (!fs::exists(path))
    throw InputError("{}: no such image; supply this file, or set anatomy.image to yours", path.string());
  Volume::Pointer volume;
  try {
    volume = fs::is_directory(path) ? read_series(path) : read_file(path);
  } catch (const itk::ExceptionObject& error) {
    throw InputError("{}: cannot be read as an image ({}); is it cut short, or of another format?",
                     path.string(), error.GetDescription());
  }
  Image image;
  const auto size = volume->GetLargestPossibleRegion().GetSize();
  for (int d = 0; d < 3; ++d) {
    image.size[d] = int(size[d]);
    image.origin[d] = volume->GetOrigin()[d];
    image.spacing[d] = volume->GetSpacing()[d];
    for (int e = 0; e < 3; ++e) image.direction(d, e) = volume->GetDirection()(d, e);
  }
  if (!(std::abs(image.direction.determinant()) > 1e-3) || !image.origin.allFinite() ||
      !image.spacing.allFinite() || !(image.spacing.minCoeff() > 0))
    throw InputError("{}: spacing, origin or direction is singular or not finite; correct the header",
                     path.string());
  const float* first = volume->GetBufferPointer();
  image.values.assign(first, first + std::size_t(size[0]) * size[1] * size[2]);
  for (std::size_t n = 0; n < image.values.size(); ++n)
    if (!std::isfinite(image.values[n]))
      throw InputError("{}: voxel ({}, {}, {}) is {}; expected finite values, export the image again",
                       path.string(), n % size[0], n / size[0] % size[1], n / size[0] / size[1],
                       image.values[n]);
  return image;
}

void write_image(const fs::path& path, const Image& image) {
  using Stored = itk::Image<short, 3>;
  const auto volume = Stored::New();
  Stored::RegionType region;
  region.SetSize({itk::SizeValueType(image.size[0]), itk::SizeValueType(image.size[1]),
                  itk::SizeValueType(image.size[2])});
  volume->SetRegions(region);
  Stored::PointType origin;
  Stored::SpacingType spacing;
  Stored::DirectionType direction;
  for (int d = 0; d < 3; ++d) {
    origin[d] = image.origin[d];
    spacing[d] = image.spacing[d];
    for (int e = 0; e < 3; ++e) direction(d, e) = image.direction(d, e);
  }
  volume->SetOrigin(origin);
  volume->SetSpacing(spacing);
  volume->SetDirection(direction);
  volume->Allocate();
  std::transform(image.values.begin(), image.values.end(), volume->GetBufferPointer(),
                 [](float value) { return short(std::lround(std::clamp(value, -32768.0f, 32767.0f))); });
  const auto writer = itk::ImageFileWriter<Stored>::New();
  writer->SetImageIO(format_of(path));
  writer->SetFileName(path.string());
  writer->SetUseCompression(true);
  writer->SetInput(volume);
  try {
    writer->Update();
  } catch (const itk::ExceptionObject& error) {
    throw EnvironmentError("{}: cannot be written ({})", path.string(), error.GetDescription());
  }
}

}  // namespace valsalva::segment
