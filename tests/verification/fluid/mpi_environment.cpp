// MPI for the whole program: the fluid's communicators need it, even on one rank.
#include <gtest/gtest.h>
#include <mpi.h>

namespace {

class MpiEnvironment : public testing::Environment {
 public:
  void SetUp() override { MPI_Init(nullptr, nullptr); }
  void TearDown() override { MPI_Finalize(); }
};

const testing::Environment* const environment = testing::AddGlobalTestEnvironment(new MpiEnvironment);

}  // namespace
