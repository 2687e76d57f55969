#include "core/mpi.hpp"

namespace valsalva::mpi {
namespace {

double reduce(MPI_Comm comm, double value, MPI_Op operation) {
  double result = 0;
  MPI_Allreduce(&value, &result, 1, MPI_DOUBLE, operation, comm);
  return result;
}

}  // namespace

Session::Session(int& argc, char**& argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
}

Session::~Session() {
  MPI_Finalize();
}

int rank(MPI_Comm comm) {
  int value = 0;
  MPI_Comm_rank(comm, &value);
  return value;
}

int size(MPI_Comm comm) {
  int value = 1;
  MPI_Comm_size(comm, &value);
  return value;
}

double sum(MPI_Comm comm, double value) {
  return reduce(comm, value, MPI_SUM);
}
double max(MPI_Comm comm, double value) {
  return reduce(comm, value, MPI_MAX);
}
double min(MPI_Comm comm, double value) {
  return reduce(comm, value, MPI_MIN);
}
bool any(MPI_Comm comm, bool value) {
  return reduce(comm, value ? 1.0 : 0.0, MPI_MAX) > 0.5;
}

void sum_in_place(MPI_Comm comm, double* values, std::size_t count) {
  if (size(comm) == 1) return;
  MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(count), MPI_DOUBLE, MPI_SUM, comm);
}

void max_in_place(MPI_Comm comm, double* values, std::size_t count) {
  if (size(comm) == 1) return;
  MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(count), MPI_DOUBLE, MPI_MAX, comm);
}

}  // namespace valsalva::mpi
