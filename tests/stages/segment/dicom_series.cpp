// ITK first: it brings a copy of Eigen of its own, which cannot come after the system's.
#include <itkGDCMImageIO.h>
#include <itkImage.h>
#include <itkImageFileWriter.h>
#include <itkMetaDataObject.h>

#include <fmt/format.h>

#include <cmath>

#include "dicom_series.hpp"

namespace valsalva::test {

std::filesystem::path slice_file(const std::filesystem::path& folder, const Series& series, int k) {
  return folder /
         fmt::format("{:03d}_{}.dcm", (k * 379 + 71) % 997, series.uid.substr(series.uid.size() - 1));
}

void write_dicom(const std::filesystem::path& folder, const segment::Image& image, const Series& series) {
  using Slice = itk::Image<short, 3>;
  std::filesystem::create_directories(folder);
  for (int k = 0; k < image.size[2]; ++k) {
    const auto slice = Slice::New();
    slice->SetRegions(
        Slice::RegionType({itk::SizeValueType(image.size[0]), itk::SizeValueType(image.size[1]), 1}));
    slice->Allocate();
    const std::size_t count = std::size_t(image.size[0]) * image.size[1];
    for (std::size_t n = 0; n < count; ++n)
      slice->GetBufferPointer()[n] = short(std::lround(image.values[k * count + n]));
    const Vec3 at = image.position(Vec3(0, 0, k));
    Slice::PointType origin;
    Slice::SpacingType spacing;
    Slice::DirectionType direction;
    for (int d = 0; d < 3; ++d) {
      origin[d] = at[d];
      spacing[d] = image.spacing[d];
      for (int e = 0; e < 3; ++e) direction(d, e) = image.direction(d, e);
    }
    slice->SetOrigin(origin);
    slice->SetSpacing(spacing);
    slice->SetDirection(direction);
    const auto format = itk::GDCMImageIO::New();
    format->KeepOriginalUIDOn();
    auto& header = slice->GetMetaDataDictionary();
    const auto put = [&](const char* tag, const std::string& value) {
      itk::EncapsulateMetaData<std::string>(header, tag, value);
    };
    put("0008|0016", "1.2.840.10008.5.1.4.1.1.2");  // CT image storage
    put("0008|0018", fmt::format("{}.{}", series.uid, k + 1));
    put("0008|0060", "CT");
    put("0020|000d", "1.2.826.0.1.3680043.2.1125.9");
    put("0020|000e", series.uid);
    put("0020|0013", std::to_string(1 + (k * 53) % image.size[2]));  // the instance number misleads, too
    put("0028|0004", "MONOCHROME2");
    put("0028|1052", fmt::format("{:g}", series.intercept));
    put("0028|1053", fmt::format("{:g}", series.slope));
    const auto writer = itk::ImageFileWriter<Slice>::New();
    writer->SetImageIO(format);
    writer->SetFileName(slice_file(folder, series, k).string());
    writer->UseInputMetaDataDictionaryOn();
    writer->SetInput(slice);
    writer->Update();
  }
}

}  // namespace valsalva::test
