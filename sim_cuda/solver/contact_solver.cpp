#include "sim_cuda/solver/contact_solver.h"

#include "sim_cuda/solver/impulse.h"
#include "sim_cuda/solver/soft_step.h"

namespace collidoscope {

template <class Real>
std::unique_ptr<ContactSolver<Real>> make_contact_solver(Solver solver, Executor& executor,
                                                         const SolverScene<Real>& scene) {
  if (solver == Solver::impulse) return std::make_unique<ImpulseSolver<Real>>(executor, scene);
  const bool coloured = solver == Solver::soft_step;
  return std::make_unique<SoftStepSolver<Real>>(executor, scene, coloured);
}

template std::unique_ptr<ContactSolver<float>> make_contact_solver(Solver, Executor&,
                                                                   const SolverScene<float>&);
template std::unique_ptr<ContactSolver<double>> make_contact_solver(Solver, Executor&,
                                                                    const SolverScene<double>&);

}  // namespace collidoscope
