#include "bezier/jacobian.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "bezier/products.h"

namespace nofacet {
namespace {

constexpr int kMaxOrder = kScaledStride - 1;
static_assert(5 * kMaxJacobianDegree <= kMaxOrder);  // above every degree met here

using BinomialTable = std::array<std::array<double, kMaxOrder + 1>, kMaxOrder + 1>;

constexpr BinomialTable make_binomials() {
  BinomialTable table{};
  for (int n = 0; n <= kMaxOrder; ++n) {
    table[n][0] = table[n][n] = 1.0;
    for (int k = 1; k < n; ++k) table[n][k] = table[n - 1][k - 1] + table[n - 1][k];
  }
  return table;
}

constexpr BinomialTable kBinomials = make_binomials();

// A form in scaled Bernstein coefficients, c_ij C(n, i) C(m, j), in which products are plain convolutions.
struct Scaled {
  int n = 0, m = 0;
  double c[kScaledStride * kScaledStride];

  double* row(int i) { return c + i * kScaledStride; }
  const double* row(int i) const { return c + i * kScaledStride; }
  void clear() { std::fill_n(c, std::size_t(n + 1) * kScaledStride, 0.0); }
};

Scaled component(const Net& net, int which) {
  Scaled s;
  s.n = net.n, s.m = net.m;
  for (int i = 0; i <= s.n; ++i) {
    for (int j = 0; j <= s.m; ++j) s.row(i)[j] = net.at(i, j)[which] * kBinomials[s.n][i] * kBinomials[s.m][j];
  }
  return s;
}

// From t^i s^(n - i) terms: d/dt of c_i is (i + 1) c_(i+1) - (n - i) c_i, of degree n - 1.
Scaled derivative_a(const Scaled& f) {
  Scaled d;
  d.n = f.n - 1, d.m = f.m;
  for (int i = 0; i <= d.n; ++i) {
    for (int j = 0; j <= d.m; ++j) d.row(i)[j] = (i + 1) * f.row(i + 1)[j] - (f.n - i) * f.row(i)[j];
  }
  return d;
}

Scaled derivative_b(const Scaled& f) {
  Scaled d;
  d.n = f.n, d.m = f.m - 1;
  for (int i = 0; i <= d.n; ++i) {
    for (int j = 0; j <= d.m; ++j) d.row(i)[j] = (j + 1) * f.row(i)[j + 1] - (f.m - j) * f.row(i)[j];
  }
  return d;
}

// out += sign f g.
void add_product(double sign, const Scaled& f, const Scaled& g, Scaled& out) {
  add_scaled_product(sign, f.c, f.n, f.m, g.c, g.n, g.m, out.c);
}

// p q - r s, whose degrees agree.
Scaled cross(const Scaled& p, const Scaled& q, const Scaled& r, const Scaled& s) {
  Scaled out;
  out.n = p.n + q.n, out.m = p.m + q.m;
  out.clear();
  add_product(1.0, p, q, out);
  add_product(-1.0, r, s, out);
  return out;
}

double largest(const Scaled& f) {
  double size = 0.0;
  for (int i = 0; i <= f.n; ++i) {
    for (int j = 0; j <= f.m; ++j) {
      size = std::max(size, std::fabs(f.row(i)[j]) / (kBinomials[f.n][i] * kBinomials[f.m][j]));
    }
  }
  return size;
}

void store(const Scaled& f, Grid out) {
  for (int i = 0; i <= f.n; ++i) {
    for (int j = 0; j <= f.m; ++j) {
      out.coefficients[i * (f.m + 1) + j] = f.row(i)[j] / (kBinomials[f.n][i] * kBinomials[f.m][j]);
    }
  }
}

// X - x W and Y - y W for a point (x, y) of the net: J does not change and distant coordinates lose no digits.
Scaled shifted(const Net& net, Component which, const Scaled& weight) {
  Scaled s = component(net, which);
  const double* origin = net.at(net.n / 2, net.m / 2);
  const double shift = origin[which] / origin[kW];
  for (int i = 0; i <= s.n; ++i) {
    for (int j = 0; j <= s.m; ++j) s.row(i)[j] -= shift * weight.row(i)[j];
  }
  return s;
}

}  // namespace

double jacobian_form(const Net& net, bool rational, Component along, Grid out) {
  const Scaled w = component(net, kW), x = shifted(net, along, w), y = shifted(net, kY, w);
  const Scaled xa = derivative_a(x), xb = derivative_b(x), ya = derivative_a(y), yb = derivative_b(y);
  if (!rational) {
    store(cross(xa, yb, xb, ya), out);
    return largest(xa) * largest(yb) + largest(xb) * largest(ya);
  }
  const Scaled wa = derivative_a(w), wb = derivative_b(w);
  const Scaled x_minor = cross(ya, wb, yb, wa), y_minor = cross(xb, wa, xa, wb), w_minor = cross(xa, yb, xb, ya);
  Scaled sum;
  sum.n = out.n, sum.m = out.m;
  sum.clear();
  add_product(1.0, x, x_minor, sum);
  add_product(1.0, y, y_minor, sum);
  add_product(1.0, w, w_minor, sum);
  store(sum, out);
  const double weight = largest(w), by_a = largest(wa), by_b = largest(wb);
  return largest(x) * (largest(ya) * by_b + largest(yb) * by_a) +
         largest(y) * (largest(xb) * by_a + largest(xa) * by_b) +
         weight * (largest(xa) * largest(yb) + largest(xb) * largest(ya));
}

double turn_form(const Net& net, bool rational, const Grid& jacobian, Grid out) {
  const Scaled w = component(net, kW), y = shifted(net, kY, w);
  Scaled ya = derivative_a(y), yb = derivative_b(y);
  if (rational) {
    ya = cross(ya, w, y, derivative_a(w));
    yb = cross(yb, w, y, derivative_b(w));
  }
  Scaled j;
  j.n = jacobian.n, j.m = jacobian.m;
  for (int i = 0; i <= j.n; ++i) {
    for (int k = 0; k <= j.m; ++k) {
      j.row(i)[k] = jacobian.coefficients[i * (j.m + 1) + k] * kBinomials[j.n][i] * kBinomials[j.m][k];
    }
  }
  const Scaled ja = derivative_a(j), jb = derivative_b(j);
  store(cross(ja, yb, jb, ya), out);
  return largest(ja) * largest(yb) + largest(jb) * largest(ya);
}

void elevate(const Grid& form, Grid out) {
  // Row r of degree N: sum over i of C(n, i) C(N - n, r - i) / C(N, r) times row i of degree n.
  const auto weight = [](int n, int to, int r, int i) {
    return kBinomials[n][i] * kBinomials[to - n][r - i] / kBinomials[to][r];
  };
  double wide[(kMaxOrder + 1) * (kMaxOrder + 1)];  // with the columns of `out`
  const int columns = out.m + 1;
  for (int column = 0; column <= out.m; ++column) {
    double* at = wide + column;
    for (int i = 0; i <= form.n; ++i) at[i * columns] = 0.0;
    for (int j = std::max(0, column - out.m + form.m); j <= std::min(form.m, column); ++j) {
      const double w = weight(form.m, out.m, column, j);
      for (int i = 0; i <= form.n; ++i) at[i * columns] += w * form.coefficients[i * (form.m + 1) + j];
    }
  }
  for (int r = 0; r <= out.n; ++r) {
    double* row = out.coefficients + r * columns;
    std::fill_n(row, columns, 0.0);
    for (int i = std::max(0, r - out.n + form.n); i <= std::min(form.n, r); ++i) {
      const double w = weight(form.n, out.n, r, i);
      for (int column = 0; column < columns; ++column) row[column] += w * wide[i * columns + column];
    }
  }
}

}  // namespace nofacet
