#include "continuum/stress/nonnegative_solve.h"

#include <cmath>

#include "continuum/parallel.h"

namespace talus {
namespace {

/// Energies that differ by less, relative to their parts, count as equal.
constexpr double energy_round_off = 1e-13;
/// A sweep is followed by another when it leaves no more than this share of the residual.
constexpr double worthwhile = 0.5;
/// Layers of cells that a growing face gains at once, at most.
constexpr int most_layers = 16;

/// The projected gradient: its largest component, and its squares in the norm of the inverse diagonal on and off the face.
struct Residual {
  double largest = 0.0, free = 0.0, chopped = 0.0;
  Residual& operator+=(const Residual& other) {
    largest = std::max(largest, other.largest);
    free += other.free;
    chopped += other.chopped;
    return *this;
  }
};

class Solve {
 public:
  Solve(const CellLevels& cells, const CellLaplacian& laplacian, Multigrid& multigrid, NonnegativeSolve& work)
      : cells_(cells), laplacian_(laplacian), multigrid_(multigrid), work_(work), n_(cells.levels[0].count) {}

  BoundQpResult run(const BoundQpSettings& settings) {
    BoundQpResult result;
    result.converged = n_ == 0;
    if (result.converged) return result;
    start();
    for (;; ++result.iterations) {
      Residual residual = advance();
      if (cold_ && residual.largest > settings.tolerance) {
        start_nested();
        residual = advance();
      }
      if (restart_) residual = sweep_while_it_helps(residual, settings.tolerance);
      result.residual = residual.largest;
      result.converged = residual.largest <= settings.tolerance;
      if (result.converged || result.iterations >= settings.max_iterations) return result;
      if (residual.chopped > residual.free) restart_ = grows_ = true;
      if (restart_) choose_face();
      if (!step()) return result;  // unbounded below: no minimiser
    }
  }

 private:
  void start() {
    const double* const inverse = laplacian_.inverse_diagonal.data();
    cold_ = true;
    for (std::ptrdiff_t i = 0; i < n_; ++i) {
      if (inverse[i] == 0.0) work_.x[i] = 0.0;
      cold_ = cold_ && work_.x[i] == 0.0;
    }
    find_gradient();
  }

  /// Only where 0 is no solution: sand in free flight has no pressure, not even a small one.
  void start_nested() {
    cold_ = false;
    for (std::ptrdiff_t i = 0; i < n_; ++i) {
      work_.free[static_cast<std::size_t>(i)] = laplacian_.inverse_diagonal[i] > 0.0;
      multigrid_.residual()[static_cast<std::size_t>(i)] = static_cast<float>(-work_.linear[i]);
    }
    multigrid_.set_free(work_.free);
    multigrid_.solve_nested();
    for (std::ptrdiff_t i = 0; i < n_; ++i)
      work_.x[i] = static_cast<double>(multigrid_.value()[static_cast<std::size_t>(i)]);
    find_gradient();
  }

  /// Takes the step decided on, and says what is left of the residual there.
  Residual advance() {
    const double length = length_;
    double *const x = work_.x.data(), *const g = work_.gradient.data();
    const double *const d = work_.direction.data(), *const product = work_.product.data(),
                        *const inverse = laplacian_.inverse_diagonal.data();
    const unsigned char* const in_face = work_.free.data();
    float* const r = multigrid_.residual().data();
    return sum_over_blocks<Residual>(n_, cells_per_block, [=](std::ptrdiff_t begin, std::ptrdiff_t end) {
      double largest = 0.0, free = 0.0, chopped = 0.0;
#pragma omp simd reduction(+ : free, chopped) reduction(max : largest)
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        const double at = std::max(0.0, x[i] + length * d[i]);
        const double gradient = g[i] + length * product[i];
        x[i] = at;
        g[i] = gradient;
        r[i] = static_cast<float>(-gradient);
        double projected = at > 0.0 ? gradient : std::min(gradient, 0.0);
        projected = inverse[i] > 0.0 ? projected : 0.0;
        largest = std::max(largest, std::abs(projected));
        const double square = projected * projected * inverse[i];
        free += in_face[i] ? square : 0.0;
        chopped += in_face[i] ? 0.0 : square;
      }
      return Residual{largest, free, chopped};
    });
  }

  /// Gauss-Seidel takes out what is local at a fraction of an iteration's price.
  Residual sweep_while_it_helps(Residual residual, double tolerance) {
    while (residual.largest > tolerance) {
      const double before = residual.largest;
      relax_nonnegative(cells_, laplacian_, work_.linear, work_.x);
      find_gradient();
      residual = advance();
      if (residual.largest > worthwhile * before) break;
    }
    return residual;
  }

  /// The cells that are positive or would rise; when it was the second that called for a new face, some layers more, twice
  /// as many each time: what is not there yet is often deep, and would come in layer by layer. What grows too far is cut.
  void choose_face() {
    work_.front.clear();
    for (std::ptrdiff_t i = 0; i < n_; ++i) {
      const bool rises = work_.x[i] == 0.0 && work_.gradient[i] < 0.0;
      const bool free = laplacian_.inverse_diagonal[i] > 0.0 && (work_.x[i] > 0.0 || rises);
      work_.free[static_cast<std::size_t>(i)] = free;
      if (free && rises) work_.front.push_back(static_cast<int>(i));
    }
    layers_ = grows_ ? std::min(std::max(1, 2 * layers_), most_layers) : 0;
    grows_ = false;
    for (int layer = 0; layer < layers_; ++layer) free_next_layer();
    multigrid_.set_free(work_.free);
  }

  /// Frees the neighbours of what was freed last.
  void free_next_layer() {
    const auto n = static_cast<std::size_t>(n_);
    const std::vector<int>& neighbours = cells_.levels[0].neighbours;
    work_.next_front.clear();
    for (const int cell : work_.front) {
      for (std::size_t k = 0; k < cells_.directions.size(); ++k) {
        const int neighbour = neighbours[k * n + static_cast<std::size_t>(cell)];
        if (neighbour == n_ || work_.free[static_cast<std::size_t>(neighbour)] ||
            laplacian_.inverse_diagonal[neighbour] == 0.0)
          continue;
        work_.free[static_cast<std::size_t>(neighbour)] = 1;
        work_.next_front.push_back(neighbour);
      }
    }
    std::swap(work_.front, work_.next_front);
  }

  /// The next direction, and how far to go along it. False where nothing bounds the energy below.
  bool step() {
    multigrid_.apply();
    turn_direction();
    const StepMeasure measure =
        multiply_and_measure(cells_, laplacian_, work_.direction, work_.x, work_.gradient, work_.product);
    restart_ = false;
    length_ = -measure.slope / measure.curvature;
    const bool bounded = measure.curvature > 0.0;
    if (bounded && length_ <= measure.feasible) return true;
    if (!bounded && !std::isfinite(measure.feasible)) return false;
    cut_step(bounded ? length_ : measure.feasible);
    length_ = 0.0;
    restart_ = true;
    return true;
  }

  /// direction = correction + beta direction, conjugate to the one before unless the face is new.
  void turn_direction() {
    const float* const z = multigrid_.value().data();
    const double* const g = work_.gradient.data();
    double* const d = work_.direction.data();
    const double product =
        sum_over_blocks(n_, cells_per_block, [=](std::ptrdiff_t begin, std::ptrdiff_t end) {
          double sum = 0.0;
#pragma omp simd reduction(+ : sum)
          for (std::ptrdiff_t i = begin; i < end; ++i) sum -= g[i] * static_cast<double>(z[i]);
          return sum;
        });
    const double beta = restart_ ? 0.0 : product / last_product_;
    last_product_ = product;
    for_each_block(n_, cells_per_block, [=](std::ptrdiff_t begin, std::ptrdiff_t end) {
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) d[i] = static_cast<double>(z[i]) + beta * d[i];
    });
  }

  /// A step that would lead below 0: cut there, unless the energy would be higher than before. A sweep follows.
  void cut_step(double length) {
    const double before = energy();
    work_.before = work_.x;
    work_.x = (work_.x + length * work_.direction).max(0.0);
    find_gradient();
    const double after = energy();
    if (after <= before + energy_round_off * std::abs(before)) return;
    work_.x = work_.before;
    find_gradient();
  }
  void find_gradient() { multiply(cells_, laplacian_, work_.x, work_.linear, work_.gradient); }
  /// 1/2 x'A x + b'x, by the gradient A x + b.
  double energy() const {
    const double *const x = work_.x.data(), *const g = work_.gradient.data(), *const b = work_.linear.data();
    return sum_over_blocks(n_, cells_per_block, [=](std::ptrdiff_t begin, std::ptrdiff_t end) {
      double sum = 0.0;
#pragma omp simd reduction(+ : sum)
      for (std::ptrdiff_t i = begin; i < end; ++i) sum += 0.5 * x[i] * (g[i] + b[i]);
      return sum;
    });
  }

  const CellLevels& cells_;
  const CellLaplacian& laplacian_;
  Multigrid& multigrid_;
  NonnegativeSolve& work_;
  std::ptrdiff_t n_;
  double length_ = 0.0, last_product_ = 0.0;
  int layers_ = 0;  // that the face grew by when it was last chosen
  bool cold_ = false, restart_ = true, grows_ = false;
};

}  // namespace

NonnegativeSolve::NonnegativeSolve(Eigen::Index cells)
    : x(Field::Zero(cells + 1)),
      linear(Field::Zero(cells + 1)),
      gradient(Field::Zero(cells + 1)),
      direction(Field::Zero(cells + 1)),
      product(Field::Zero(cells + 1)),
      before(Field::Zero(cells + 1)),
      free(static_cast<std::size_t>(cells), 0) {
  front.reserve(free.size());
  next_front.reserve(free.size());
}

BoundQpResult minimise_nonnegative(const CellLevels& cells, const CellLaplacian& laplacian,
                                   const BoundQpSettings& settings, Multigrid& multigrid,
                                   NonnegativeSolve& work) {
  return Solve(cells, laplacian, multigrid, work).run(settings);
}

}  // namespace talus
