#pragma once

namespace orbifit {

/// A sum of products as if in twice the digits, rounded once at the end (Ogita, Rump and Oishi, Accurate sum and dot
/// product, 2005). In doubles, so that it costs the same everywhere; for numbers below 1e290.
class PreciseSum {
 public:
  explicit PreciseSum(double start = 0) : sum_(start) {}

  void add_product(double a, double b) {
    const double product = a * b;
    const Halves x(a), y(b);
    add(product, ((x.high * y.high - product) + x.high * y.low + x.low * y.high) + x.low * y.low);
  }
  /// What a sum has beyond doubles counts as well.
  void add_product(double a, const PreciseSum& b) {
    add_product(a, b.sum_);
    error_ += a * b.error_;
  }
  double value() const { return sum_ + error_; }

 private:
  struct Halves {  // of a double's digits (Veltkamp)
    explicit Halves(double number) {
      const double scaled = 134217729 * number;  // 2^27 + 1
      high = scaled - (scaled - number);
      low = number - high;
    }
    double high, low;
  };

  void add(double number, double error) {
    const double sum = sum_ + number;
    const double kept = sum - sum_;
    error_ += ((sum_ - (sum - kept)) + (number - kept)) + error;
    sum_ = sum;
  }

  double sum_, error_ = 0;
};

}  // namespace orbifit
