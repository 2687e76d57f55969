// A scalar volume in scanner coordinates, and its files. Positions are LPS, mm: x to the patient's left,
// y to the back, z to the head (DICOM's and ITK's convention).
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "core/types.hpp"

namespace valsalva::segment {

struct Image {
  std::array<int, 3> size{};
  Vec3 origin = Vec3::Zero();  ///< position of the centre of voxel (0, 0, 0)
  Vec3 spacing = Vec3::Ones();
  Mat3 direction = Mat3::Identity();  ///< columns: directions of the index axes
  std::vector<float> values;          ///< x fastest

  Vec3 position(const Vec3& index) const { return origin + direction * spacing.cwiseProduct(index); }
  Vec3 index(const Vec3& position) const;
  bool contains(const Vec3& position) const;
  /// Trilinear; outside the volume the nearest voxel's value.
  double sample(const Vec3& position) const;
  float at(int i, int j, int k) const { return values[(std::size_t(k) * size[1] + j) * size[0] + i]; }
};

/// NRRD (.nrrd, .nhdr), NIfTI (.nii, .nii.gz), MetaImage (.mha, .mhd), or a folder with a DICOM series: of
/// several, the one with the most slices (the log names them all); slices are ordered by their positions,
/// whatever their names; other files are passed over. InputError: missing or cut-short file, unknown format,
/// not three dimensions, a spacing that is not positive, a direction that is singular, values that are not
/// finite; slices of several sizes or directions, two in one place, or in uneven steps (0.05 mm).
Image read_image(const std::filesystem::path& path);

/// By the ending, as above; 16-bit integers, compressed. EnvironmentError when it cannot be written.
void write_image(const std::filesystem::path& path, const Image& image);

/// The voxels within `half_width_mm` of `centre` in every direction of the index axes.
Image cropped(const Image& image, const Vec3& centre, double half_width_mm);

/// Edge-preserving diffusion (Perona and Malik 1990, eq. 7 with the exponential conductance, in voxels):
/// dI = (1/7) sum over the six neighbours of g(d) d, d = I_neighbour - I, g = exp(-(d / contrast)^2).
void denoise(Image& image, double contrast, int steps);

}  // namespace valsalva::segment
