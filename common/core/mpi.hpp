// The MPI session of a program, and the few collective calls the modules use.
#pragma once

#include <mpi.h>

#include <vector>

namespace valsalva::mpi {

/// Starts MPI at construction and ends it at destruction; one per program, first thing in main.
class Session {
 public:
  Session(int& argc, char**& argv);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

int rank(MPI_Comm comm);
int size(MPI_Comm comm);
double sum(MPI_Comm comm, double value);
double max(MPI_Comm comm, double value);
double min(MPI_Comm comm, double value);
bool any(MPI_Comm comm, bool value);
/// Adds the vectors of all ranks, element by element; every rank holds the sum. Sizes must agree.
void sum_in_place(MPI_Comm comm, double* values, std::size_t count);
/// The largest of all ranks, element by element.
void max_in_place(MPI_Comm comm, double* values, std::size_t count);

}  // namespace valsalva::mpi
