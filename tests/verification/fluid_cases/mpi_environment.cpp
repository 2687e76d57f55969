// The fluid's communicators need MPI, even on one rank.
#include "mpi_for_all.hpp"
