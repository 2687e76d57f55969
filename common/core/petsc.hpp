// PETSc for the whole program, started by whoever needs it first; who includes this links PETSc.
#pragma once

#include <petscsys.h>

#include "core/errors.hpp"

namespace valsalva::petsc {

/// EnvironmentError when a call of PETSc failed.
inline void require(PetscErrorCode code, const char* what) {
  if (code != 0) throw EnvironmentError("PETSc: {} failed with code {}", what, static_cast<int>(code));
}

/// Starts PETSc, and MPI too unless the program has started it; it ends with the program. Its errors come
/// back as codes, signals are left to the program.
inline void start() {
  class Library {
   public:
    Library() {
      PetscBool running = PETSC_FALSE;
      PetscInitialized(&running);
      if (running) return;
      require(PetscOptionsSetValue(nullptr, "-no_signal_handler", "true"), "options");
      require(PetscInitializeNoArguments(), "start");
      require(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr), "error handler");
      owner_ = true;
    }
    ~Library() {
      int ended = 0;
      MPI_Finalized(&ended);
      if (owner_ && !ended) PetscFinalize();
    }

   private:
    bool owner_ = false;
  };
  static const Library library;
}

/// Objects can be released no more after MPI has ended.
inline bool can_release() {
  int ended = 0;
  MPI_Finalized(&ended);
  return !ended;
}

}  // namespace valsalva::petsc
