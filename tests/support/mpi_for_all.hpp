// MPI for a whole test program, from its first test to its last: include it in any of the program's sources.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "core/mpi.hpp"

namespace valsalva::test {

class MpiForAll : public testing::Environment {
 public:
  void SetUp() override {
    int argc = 0;
    char** argv = nullptr;
    session_ = std::make_unique<mpi::Session>(argc, argv);
  }
  void TearDown() override { session_.reset(); }

 private:
  std::unique_ptr<mpi::Session> session_;
};

inline const auto* const mpi_for_all = testing::AddGlobalTestEnvironment(new MpiForAll);

}  // namespace valsalva::test
