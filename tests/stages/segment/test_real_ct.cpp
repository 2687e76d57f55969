// The real CT of the reference data: overlap with its aorta mask, and the annulus diameters of its report.
#include "anatomy.hpp"
#include "root.hpp"
#include "support.hpp"

namespace {

using namespace valsalva;

TEST(RealCt, OverlapsTheAortaMaskAndMeetsTheReport) {
  const std::filesystem::path folder =
      std::filesystem::path(VALSALVA_SOURCE_DIR) / ".." / "shared" / "reference" / "ct_thorax";
  if (!std::filesystem::exists(folder / "ct_cropped.nii.gz"))
    GTEST_SKIP() << "the reference data is absent: " << folder << " (ct_cropped.nii.gz, aorta.nii.gz)";
  const Case scene = test::case_of(
      "[anatomy]\nkind = \"ct\"\nimage = \"x\"\ncoordinates = \"RAS\"\n"
      "annulus_centre_mm = [-14.0, 184.1, 660.8]\nannulus_normal = [0.53, 0.26, 0.81]\n");
  const segment::Anatomy found = segment::anatomy_of(scene, folder / "ct_cropped.nii.gz");
  const auto& lumen = found.lumen;
  const segment::Root root = segment::measure_root(lumen.distance, lumen.z_lower_mm, lumen.z_upper_mm, 5);
  EXPECT_NEAR(root.annulus.greatest_mm, 27, 2);
  EXPECT_NEAR(root.annulus.least_mm, 23, 2);

  // Root and ascending aorta: between annulus and upper cut, near the centreline (the mask also has the
  // descending aorta at these heights).
  const segment::Image mask = segment::read_image(folder / "aorta.nii.gz");
  double both = 0, ours = 0, theirs = 0;
  for (int k = 0; k < mask.size[2]; ++k)
    for (int j = 0; j < mask.size[1]; ++j)
      for (int i = 0; i < mask.size[0]; ++i) {
        const Vec3 x = lumen.frame.from_scanner(mask.position(Vec3(i, j, k)));
        if (x.z() < 0 || x.z() > lumen.z_upper_mm) continue;
        double away = 1e9;
        for (const auto& p : root.centreline) away = std::min(away, (p.position - x).norm());
        if (away > 28) continue;
        const bool in_mask = mask.at(i, j, k) > 0, in_lumen = lumen.distance.value(x) < 0;
        both += in_mask && in_lumen;
        ours += in_lumen;
        theirs += in_mask;
      }
  const double dice = 2 * both / (ours + theirs);
  RecordProperty("dice", std::to_string(dice));
  std::printf("Dice %.3f; annulus %.1f x %.1f mm\n", dice, root.annulus.greatest_mm, root.annulus.least_mm);
  EXPECT_GE(dice, 0.90);
}

}  // namespace
