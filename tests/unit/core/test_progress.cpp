// The bar is for people: not for files, and not for the terminal that mpirun makes for itself.
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "core/errors.hpp"
#include "core/progress.hpp"

using namespace valsalva;

namespace {

TEST(Progress, BarOnlyOnATerminalThatAPersonLooksAt) {
  EXPECT_TRUE(draws_bar({.terminal = true, .kind = "xterm"}));
  EXPECT_TRUE(draws_bar({.terminal = true}));
  EXPECT_FALSE(draws_bar({.terminal = false, .kind = "xterm"}));
  EXPECT_FALSE(draws_bar({.terminal = true, .mpi_size = "1", .kind = "xterm"}));
  EXPECT_FALSE(draws_bar({.terminal = true, .mpi_size = "2", .kind = "xterm"}));
  EXPECT_FALSE(draws_bar({.terminal = true, .kind = "dumb"}));
}

TEST(Progress, AWishDecides) {
  EXPECT_TRUE(draws_bar({.terminal = true, .mpi_size = "2", .wish = "bar"}));
  EXPECT_TRUE(draws_bar({.terminal = false, .wish = "bar"}));
  EXPECT_FALSE(draws_bar({.terminal = true, .wish = "lines"}));
  EXPECT_TRUE(draws_bar({.terminal = true, .wish = ""}));
  EXPECT_THROW(draws_bar({.terminal = true, .wish = "no"}), InputError);
}

// What a child process with a terminal of its own writes in a third of a second of work.
std::string on_a_terminal(bool under_mpirun) {
  int master = -1;
  const pid_t child = forkpty(&master, nullptr, nullptr, nullptr);
  if (child == 0) {
    setenv("TERM", "xterm", 1);
    unsetenv("VALSALVA_PROGRESS");
    unsetenv("OMPI_COMM_WORLD_SIZE");
    if (under_mpirun) setenv("OMPI_COMM_WORLD_SIZE", "2", 1);
    {
      Progress progress("work", 10, true);
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      progress.update(4);
    }
    std::fflush(stdout);
    _exit(0);
  }
  std::string text;
  char part[256];
  for (ssize_t n; (n = read(master, part, sizeof part)) > 0;) text.append(part, n);
  close(master);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  return text;
}

TEST(Progress, DrawsOnATerminalAndNotUnderMpirun) {
  EXPECT_NE(on_a_terminal(false).find("\r\033[K[=========               ] work  40.0 %"), std::string::npos);
  EXPECT_EQ(on_a_terminal(true).find('\r'), std::string::npos);
}

}  // namespace
