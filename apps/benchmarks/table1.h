#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arap.h"
#include "models.h"

namespace orbifit::benchmarks {

/// The soft-constraint variant at one weight.
struct SoftRow {
  double weight = 0;
  double prefactor_ms = 0, solve5_ms = 0;
  double residual = 0;  ///< of the samples, fraction of the diagonal
};

/// A model's figures with one number of threads; times in milliseconds.
struct Table1Row {
  std::string model;
  PaperRow paper;
  int threads = 1;
  int vertices = 0, triangles = 0, groups = 0, samples = 0, degrees_of_freedom = 0;
  double radius = 0;  ///< fraction of the diagonal
  double build_ms = 0, setup_ms = 0, prefactor_ms = 0, solve5_ms = 0, lift_ms = 0;
  double lift_floor_ms = 0;
  double lift_bytes = 0;
  double field_residual = 0, mesh_residual = 0, handle_error = 0;  ///< fractions of the diagonal
  std::optional<ArapTimes> arap;                                   ///< the peers use one thread
  std::vector<SoftRow> soft;
};

/// The tables for people, at most 120 columns wide.
std::string table1_text(const std::vector<Table1Row>& rows);

/// An array with an object for each row.
std::string table1_json(const std::vector<Table1Row>& rows);

}  // namespace orbifit::benchmarks
