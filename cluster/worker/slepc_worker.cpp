// The program chladni-slepc: the modes of K φ = λ M φ below a bound, on all ranks of MPI. It alone
// links PETSc, SLEPc and MPI. SLEPc slices the spectrum: Krylov-Schur about some shifts, where
// MUMPS counts the eigenvalues below by the signs of the pivots of K − σM (Campos and Roman 2012,
// Numer. Algorithms 60, 279-295). A factor of K + sM then refines the shapes.
//
// chladni-slepc FOLDER WANTED SHIFT BOUND: K and M are in the folder (stiffness.petsc, mass.petsc),
// the modes are left there (cluster/reply.h). BOUND [s^-2] is raised until WANTED eigenvalues lie
// below it. The exit status is 0, 3 (arguments), 4 (PETSc, SLEPc or MUMPS gave up) or 5 (memory);
// the reason is the line that begins with "chladni-slepc:".
#include <slepceps.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "cluster/worker/reply_text.h"

namespace {

constexpr int kRaises = 20;           // of the bound
constexpr double kTolerance = 1e-12;  // of SLEPc

struct Task {
  std::string folder;
  PetscInt wanted = 0;
  double shift = 0.0, bound = 0.0;
};

struct Problem {
  Mat stiffness = nullptr, mass = nullptr;
};

struct Modes {
  std::vector<double> lambda;
  std::vector<Vec> shapes, corrections;
  std::vector<double> shifts;
  std::vector<PetscInt> below;  // eigenvalues below each shift
  PetscInt counted = 0;
};

// What PETSc says of an error, in one line; all ranks end.
PetscErrorCode end_all(MPI_Comm, int, const char* function, const char*, PetscErrorCode code,
                       PetscErrorType type, const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) {
    std::fprintf(stderr, "chladni-slepc: %s (%s)\n", message, function);
    std::fflush(stderr);
    MPI_Abort(MPI_COMM_WORLD, code == PETSC_ERR_MEM ? 5 : 4);
  }
  return code;
}

int refused(const std::string& why) {
  std::fprintf(stderr, "chladni-slepc: %s\n", why.c_str());
  return 3;
}

// One thread per rank unless the user says more: both libraries read their environment while they
// are loaded.
void use_one_thread(char** argv) {
  const bool stated = std::getenv("OPENBLAS_NUM_THREADS") && std::getenv("OMP_NUM_THREADS");
  for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"}) setenv(name, "1", 0);
  if (!stated) execv("/proc/self/exe", argv);
}

// Unless the user's PETSC_OPTIONS say otherwise. ICNTL(13) 1: the last front is not given to
// ScaLAPACK, which counts no pivots. ICNTL(24) 1: null pivots are detected. ICNTL(14): per cent of
// more room for pivots that are delayed.
PetscErrorCode set_defaults() {
  PetscFunctionBeginUser;
  constexpr std::array<std::pair<const char*, const char*>, 3> defaults = {
      {{"mat_mumps_icntl_13", "1"}, {"mat_mumps_icntl_24", "1"}, {"mat_mumps_icntl_14", "40"}}};
  for (const auto& [name, value] : defaults) {
    for (const char* prefix : {"-st_", "-"}) {  // of the slices, of the refinement
      const std::string option = std::string(prefix) + name;
      PetscBool there = PETSC_FALSE;
      PetscCall(PetscOptionsHasName(nullptr, nullptr, option.c_str(), &there));
      if (there == PETSC_FALSE) PetscCall(PetscOptionsSetValue(nullptr, option.c_str(), value));
    }
  }
  PetscFunctionReturn(0);
}

PetscErrorCode load(const std::string& file, Mat* matrix) {
  PetscFunctionBeginUser;
  PetscViewer viewer = nullptr;
  PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, file.c_str(), FILE_MODE_READ, &viewer));
  PetscCall(MatCreate(PETSC_COMM_WORLD, matrix));
  PetscCall(MatSetType(*matrix, MATAIJ));
  PetscCall(MatLoad(*matrix, viewer));
  PetscCall(PetscViewerDestroy(&viewer));
  PetscCall(MatSetOption(*matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatSetOption(*matrix, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  PetscFunctionReturn(0);
}

PetscErrorCode use_mumps(KSP solver) {
  PetscFunctionBeginUser;
  PC factor = nullptr;
  PetscCall(KSPSetType(solver, KSPPREONLY));
  PetscCall(KSPGetPC(solver, &factor));
  PetscCall(PCSetType(factor, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(factor, MATSOLVERMUMPS));
  PetscFunctionReturn(0);
}

PetscErrorCode new_slices(const Problem& problem, double low, double bound, EPS* solver) {
  PetscFunctionBeginUser;
  PetscCall(EPSCreate(PETSC_COMM_WORLD, solver));
  PetscCall(EPSSetOperators(*solver, problem.stiffness, problem.mass));
  PetscCall(EPSSetProblemType(*solver, EPS_GHEP));
  PetscCall(EPSSetType(*solver, EPSKRYLOVSCHUR));
  PetscCall(EPSSetWhichEigenpairs(*solver, EPS_ALL));
  PetscCall(EPSSetInterval(*solver, low, bound));
  PetscCall(EPSSetTolerances(*solver, kTolerance, PETSC_DEFAULT));
  PetscCall(EPSKrylovSchurSetDetectZeros(*solver, PETSC_TRUE));
  ST transform = nullptr;
  KSP inner = nullptr;
  PetscCall(EPSGetST(*solver, &transform));
  PetscCall(STSetType(transform, STSINVERT));
  PetscCall(STSetMatStructure(transform, UNKNOWN_NONZERO_PATTERN));
  PetscCall(STGetKSP(transform, &inner));
  PetscCall(use_mumps(inner));
  PetscCall(EPSSetFromOptions(*solver));
  PetscFunctionReturn(0);
}

PetscErrorCode take_counts(EPS solver, Modes* modes) {
  PetscFunctionBeginUser;
  PetscInt count = 0;
  PetscReal* shifts = nullptr;
  PetscInt* below = nullptr;
  PetscCall(EPSKrylovSchurGetInertias(solver, &count, &shifts, &below));
  modes->shifts.assign(shifts, shifts + count);
  modes->below.assign(below, below + count);
  PetscCall(PetscFree(shifts));
  PetscCall(PetscFree(below));
  PetscFunctionReturn(0);
}

struct Bracket {
  double low = 0.0, high = 0.0;  // bounds with too few and too many below; 0: none
};

// The bound after the task's, below which `counted` lie; the same where the number is right. It is
// raised by more each time, and lowered only after that.
double next_bound(PetscInt counted, const Task& task, Bracket* tried, int raise) {
  const bool too_few = counted < task.wanted;
  if (!too_few && !(tried->low > 0.0 && counted > 3 * task.wanted + 30)) return task.bound;
  (too_few ? tried->low : tried->high) = task.bound;
  if (tried->high > 0.0) return std::sqrt(tried->low * tried->high);
  const double lack = static_cast<double>(task.wanted) / static_cast<double>(counted + 1);
  return task.bound * std::max(std::pow(std::min(1.2 * lack, 10.0), 2), std::pow(2.0, raise + 1));
}

// Slices up to a bound with the wanted number of eigenvalues below it: counted, not yet found.
PetscErrorCode counted_slices(const Problem& problem, Task* task, EPS* solver, Modes* modes) {
  PetscFunctionBeginUser;
  Bracket tried;
  for (int raise = 0;; ++raise) {
    PetscCall(new_slices(problem, -task->shift, task->bound, solver));
    PetscCall(EPSSetUp(*solver));
    PetscCall(take_counts(*solver, modes));
    modes->counted = modes->below.back() - modes->below.front();
    const double next = next_bound(modes->counted, *task, &tried, raise);
    if (next == task->bound) break;
    PetscCheck(raise < kRaises, PETSC_COMM_WORLD, PETSC_ERR_CONV_FAILED,
               "%" PetscInt_FMT " eigenvalues lie below %g s^-2, and %" PetscInt_FMT " are wanted",
               modes->counted, task->bound, task->wanted);
    PetscCall(EPSDestroy(solver));
    task->bound = next;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode find(const Problem& problem, Task* task, Modes* modes) {
  PetscFunctionBeginUser;
  EPS solver = nullptr;
  PetscCall(counted_slices(problem, task, &solver, modes));
  if (modes->counted > 0) PetscCall(EPSSolve(solver));
  PetscCall(take_counts(solver, modes));
  PetscInt found = 0;
  PetscCall(EPSGetConverged(solver, &found));
  for (PetscInt i = 0; i < found; ++i) {
    PetscScalar lambda = 0.0;
    Vec shape = nullptr;
    PetscCall(MatCreateVecs(problem.stiffness, &shape, nullptr));
    PetscCall(EPSGetEigenpair(solver, i, &lambda, nullptr, shape, nullptr));
    modes->lambda.push_back(lambda);
    modes->shapes.push_back(shape);
  }
  PetscCall(EPSDestroy(&solver));
  PetscFunctionReturn(0);
}

// Scales φ to φᵀMφ = 1. λ := φᵀKφ, right := Kφ − λMφ.
PetscErrorCode take_residual(const Problem& problem, Vec shape, Vec work, double* lambda,
                             Vec right) {
  PetscFunctionBeginUser;
  double norm = 0.0;
  PetscCall(MatMult(problem.mass, shape, work));
  PetscCall(VecDot(shape, work, &norm));
  PetscCall(VecScale(shape, 1.0 / std::sqrt(norm)));
  PetscCall(VecScale(work, 1.0 / std::sqrt(norm)));
  PetscCall(MatMult(problem.stiffness, shape, right));
  PetscCall(VecDot(shape, right, lambda));
  PetscCall(VecAXPY(right, -*lambda, work));
  PetscFunctionReturn(0);
}

// The columns x = (K + sM)⁻¹(Kφ − λMφ) of all modes by one solve: MUMPS takes as long for some as
// for one.
PetscErrorCode solve_corrections(const Problem& problem, Mat factor, Mat right, Vec work,
                                 Modes* modes, Mat corrections) {
  PetscFunctionBeginUser;
  for (std::size_t i = 0; i < modes->shapes.size(); ++i) {
    Vec column = nullptr;
    PetscCall(MatDenseGetColumnVecWrite(right, static_cast<PetscInt>(i), &column));
    PetscCall(take_residual(problem, modes->shapes[i], work, &modes->lambda[i], column));
    PetscCall(MatDenseRestoreColumnVecWrite(right, static_cast<PetscInt>(i), &column));
  }
  PetscCall(MatMatSolve(factor, right, corrections));
  for (std::size_t i = 0; i < modes->shapes.size(); ++i) {
    Vec column = nullptr;
    PetscCall(MatDenseGetColumnVecRead(corrections, static_cast<PetscInt>(i), &column));
    PetscCall(VecCopy(column, modes->corrections[i]));
    PetscCall(MatDenseRestoreColumnVecRead(corrections, static_cast<PetscInt>(i), &column));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode new_inverse(const Problem& problem, double shift, KSP* inverse) {
  PetscFunctionBeginUser;
  Mat shifted = nullptr;
  PetscCall(MatDuplicate(problem.stiffness, MAT_COPY_VALUES, &shifted));
  PetscCall(MatAXPY(shifted, shift, problem.mass, UNKNOWN_NONZERO_PATTERN));
  PetscCall(MatSetOption(shifted, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatSetOption(shifted, MAT_SPD, PETSC_TRUE));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, inverse));
  PetscCall(KSPSetOperators(*inverse, shifted, shifted));
  PetscCall(MatDestroy(&shifted));
  PetscCall(use_mumps(*inverse));
  PetscCall(KSPSetErrorIfNotConverged(*inverse, PETSC_TRUE));
  PetscCall(KSPSetUp(*inverse));
  PetscFunctionReturn(0);
}

PetscErrorCode new_block(const Problem& problem, std::size_t columns, Mat* block) {
  PetscFunctionBeginUser;
  PetscInt local = 0;
  PetscCall(MatGetLocalSize(problem.stiffness, &local, nullptr));
  PetscCall(MatCreateDense(PETSC_COMM_WORLD, local, PETSC_DECIDE, PETSC_DETERMINE,
                           static_cast<PetscInt>(columns), nullptr, block));
  PetscCall(MatAssemblyBegin(*block, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*block, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

// One step of inverse iteration, φ − x. The x of what it gives stays beside it.
PetscErrorCode refine_with(const Problem& problem, double shift, Mat factor, Modes* modes) {
  PetscFunctionBeginUser;
  Mat right = nullptr;
  Mat corrections = nullptr;
  Vec work = nullptr;
  PetscCall(new_block(problem, modes->shapes.size(), &right));
  PetscCall(new_block(problem, modes->shapes.size(), &corrections));
  PetscCall(MatCreateVecs(problem.stiffness, &work, nullptr));
  PetscCall(solve_corrections(problem, factor, right, work, modes, corrections));
  for (std::size_t i = 0; i < modes->shapes.size(); ++i) {
    if (modes->lambda[i] < 1e-9 * shift) continue;  // a motion of the whole body
    PetscCall(VecAXPY(modes->shapes[i], -1.0, modes->corrections[i]));
  }
  PetscCall(solve_corrections(problem, factor, right, work, modes, corrections));
  PetscCall(VecDestroy(&work));
  PetscCall(MatDestroy(&right));
  PetscCall(MatDestroy(&corrections));
  PetscFunctionReturn(0);
}

PetscErrorCode refine(const Problem& problem, const Task& task, Modes* modes) {
  PetscFunctionBeginUser;
  if (modes->shapes.empty()) PetscFunctionReturn(0);
  for (Vec shape : modes->shapes) {
    modes->corrections.push_back(nullptr);
    PetscCall(VecDuplicate(shape, &modes->corrections.back()));
  }
  KSP inverse = nullptr;
  PC preconditioner = nullptr;
  Mat factor = nullptr;
  PetscCall(new_inverse(problem, task.shift, &inverse));
  PetscCall(KSPGetPC(inverse, &preconditioner));
  PetscCall(PCFactorGetMatrix(preconditioner, &factor));
  PetscCall(refine_with(problem, task.shift, factor, modes));
  PetscCall(KSPDestroy(&inverse));
  PetscFunctionReturn(0);
}

// The numbers of all vectors, one after the other, big-endian, without headers.
PetscErrorCode leave_vectors(const std::string& file, const std::vector<Vec>& vectors) {
  PetscFunctionBeginUser;
  PetscViewer viewer = nullptr;
  PetscCall(PetscViewerCreate(PETSC_COMM_WORLD, &viewer));
  PetscCall(PetscViewerSetType(viewer, PETSCVIEWERBINARY));
  PetscCall(PetscViewerFileSetMode(viewer, FILE_MODE_WRITE));
  PetscCall(PetscViewerBinarySkipInfo(viewer));
  PetscCall(PetscViewerBinarySetSkipHeader(viewer, PETSC_TRUE));
  PetscCall(PetscViewerFileSetName(viewer, file.c_str()));
  for (Vec vector : vectors) PetscCall(VecView(vector, viewer));
  PetscCall(PetscViewerDestroy(&viewer));
  PetscFunctionReturn(0);
}

// Peak resident bytes of each rank, on the first one.
PetscErrorCode peak_bytes(std::vector<double>* peaks) {
  PetscFunctionBeginUser;
  int ranks = 0;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double own = 1024.0 * static_cast<double>(usage.ru_maxrss);
  peaks->resize(static_cast<std::size_t>(ranks));
  PetscCallMPI(MPI_Gather(&own, 1, MPI_DOUBLE, peaks->data(), 1, MPI_DOUBLE, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

// reply.txt, the last file: where it is, the others are whole.
PetscErrorCode leave_reply(const Task& task, const Modes& modes, PetscInt rows, double seconds) {
  PetscFunctionBeginUser;
  chladni::cluster::ReplyText reply{rows,
                                    modes.counted,
                                    task.bound,
                                    seconds,
                                    {},
                                    modes.shifts,
                                    {modes.below.begin(), modes.below.end()},
                                    modes.lambda};
  int rank = 0;
  PetscCall(peak_bytes(&reply.peak_bytes));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank != 0) PetscFunctionReturn(0);
  std::FILE* out = std::fopen((task.folder + "/reply.txt").c_str(), "w");
  PetscCheck(out != nullptr, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "cannot write to %s",
             task.folder.c_str());
  print(reply, out);
  const bool is_written = std::ferror(out) == 0;
  PetscCheck(std::fclose(out) == 0 && is_written, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE,
             "cannot write to %s", task.folder.c_str());
  PetscFunctionReturn(0);
}

PetscErrorCode solve(Task task) {
  PetscFunctionBeginUser;
  const auto start = std::chrono::steady_clock::now();
  Problem problem;
  Modes modes;
  PetscInt rows = 0;
  PetscCall(set_defaults());
  PetscCall(load(task.folder + "/stiffness.petsc", &problem.stiffness));
  PetscCall(load(task.folder + "/mass.petsc", &problem.mass));
  PetscCall(MatGetSize(problem.stiffness, &rows, nullptr));
  PetscCall(find(problem, &task, &modes));
  PetscCall(refine(problem, task, &modes));
  PetscCall(leave_vectors(task.folder + "/shapes.petsc", modes.shapes));
  PetscCall(leave_vectors(task.folder + "/corrections.petsc", modes.corrections));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  PetscCall(leave_reply(task, modes, rows, took.count()));
  for (auto* vectors : {&modes.shapes, &modes.corrections}) {
    for (Vec& vector : *vectors) PetscCall(VecDestroy(&vector));
  }
  PetscCall(MatDestroy(&problem.stiffness));
  PetscCall(MatDestroy(&problem.mass));
  PetscFunctionReturn(0);
}

}  // namespace

int main(int argc, char** argv) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a rank does not outlive what started it
  if (argc != 5) return refused("expected FOLDER WANTED SHIFT BOUND");
  use_one_thread(argv);
  const Task task{argv[1], static_cast<PetscInt>(std::atol(argv[2])), std::atof(argv[3]),
                  std::atof(argv[4])};
  if (!(task.shift > 0.0) || !(task.bound > 0.0) || task.wanted < 0) {
    return refused("WANTED must be 0 or more, SHIFT and BOUND more than 0");
  }
  if (SlepcInitialize(&argc, &argv, nullptr, nullptr) != 0) return refused("SLEPc does not start");
  PetscPushErrorHandler(end_all, nullptr);
  if (solve(task) != 0) MPI_Abort(MPI_COMM_WORLD, 4);
  return SlepcFinalize() == 0 ? 0 : 4;
}
