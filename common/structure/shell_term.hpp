// A shell body as one force term of a System.
#pragma once

#include <memory>
#include <string>

#include "structure/force_term.hpp"
#include "structure/shell.hpp"

namespace valsalva::structure {

class ShellTerm : public ForceTerm {
 public:
  ShellTerm(std::shared_ptr<const Shell> shell, const Body& body) : shell_(std::move(shell)), body_(body) {}
  std::string name() const override { return body_.name; }
  double add_forces(const Configuration& now, Forces& out) const override {
    return shell_->add_forces(now.x, out.force, body_.offset);
  }
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override {
    shell_->add_stiffness_bound(now.x, out.translation, body_.offset);
  }
  void add_tangent(const Configuration& now, BlockMatrix& out) const override {
    shell_->add_tangent(now.x, out, body_.offset);
  }
  const Shell& shell() const { return *shell_; }

 private:
  std::shared_ptr<const Shell> shell_;
  Body body_;
};

}  // namespace valsalva::structure
