#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/provenance.hpp"
#include "core/run_folder.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace valsalva {
namespace {

void touch(const std::filesystem::path& path) {
  std::ofstream(path) << "x";
}

TEST(RunFolder, ListsStatesByIndexAndKeepsTwo) {
  const test::TemporaryFolder folder;
  const RunFolder run(folder / "a/b");
  for (const long index : {7, 100, 20}) touch(run.state_path(index));
  touch(run.file("state_000200.h5.part"));
  touch(run.file("state_x.h5"));
  ASSERT_EQ(run.states().size(), 3u);
  EXPECT_EQ(run.latest_state(), run.state_path(100));
  run.prune();
  ASSERT_EQ(run.states().size(), 2u);
  EXPECT_EQ(run.states().front(), run.state_path(20));
}

TEST(RunFolder, AFreshRunRemovesOldStatesOnlyAfterItsFirstOwn) {
  const test::TemporaryFolder folder;
  RunFolder run(folder.path());
  for (const long index : {5, 9}) touch(run.state_path(index));
  run.disregard_present_states();
  EXPECT_FALSE(run.latest_state());
  run.prune();
  EXPECT_TRUE(std::filesystem::exists(run.state_path(9)));
  touch(folder / "new");
  std::filesystem::rename(folder / "new", run.state_path(5));  // the new run's state takes an old name
  run.prune();
  EXPECT_EQ(run.latest_state(), run.state_path(5));
  EXPECT_FALSE(std::filesystem::exists(run.state_path(9)));
}

TEST(RunFolder, AnImpossibleFolderIsAnEnvironmentError) {
  const test::TemporaryFolder folder;
  touch(folder / "file");
  test::expect_error(ExitCode::environment, {"file/run", "--out"}, [&] { RunFolder(folder / "file/run"); });
}

TEST(Summary, WhatCouldNotBeComputedIsNull) {
  Summary summary;
  summary.metrics["eoa_cm2"] = std::nan("");
  summary.metrics["goa_max_cm2"] = 2.0;
  const nlohmann::json json = summary.to_json();
  EXPECT_TRUE(json["metrics"]["eoa_cm2"].is_null());
  EXPECT_EQ(json["metrics"]["goa_max_cm2"], 2.0);
}

TEST(History, RestoresToTheSameTable) {
  History history({"time_s", "p_ao_mmHg"});
  history.add({0.1, 80});
  history.add({0.2, 81});
  History other({"time_s", "p_ao_mmHg"});
  other.restore(history.values());
  EXPECT_EQ(other.rows(), 2u);
  EXPECT_EQ(other.at(1, "p_ao_mmHg"), 81);
  EXPECT_EQ(other.column("time_s"), (std::vector<double>{0.1, 0.2}));
}

TEST(Provenance, DigestOfAKnownText) {
  EXPECT_EQ(sha256_of_text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(WriteAtomically, LeavesNoPartBehind) {
  const test::TemporaryFolder folder;
  write_atomically(folder / "a.txt", "hello");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt.part"));
  EXPECT_EQ(sha256_of_path(folder / "a.txt"), sha256_of_text("hello"));
  test::expect_error(ExitCode::environment, {"/dev/full"}, [] { write_atomically("/dev/full/x", "hello"); });
}

}  // namespace
}  // namespace valsalva
