#pragma once

#include <filesystem>
#include <vector>

#include "orbifit/model/run_context.h"

#include "batch/collection.h"
#include "batch/same_shapes.h"

namespace orbifit::batch {

/// A table of the export, as docs/collections.md describes it.
struct Column {
  const char* name;
  const char* type;  ///< TEXT, INTEGER or REAL
};
struct TableSchema {
  const char* name;
  std::vector<Column> columns;
};
const std::vector<TableSchema>& export_tables();  ///< items, regions, patterns

/// Writes the tables as a database of SQLite. Whole or not at all. \throw InputError when it cannot be written
void write_database(const Collection& collection, const SameShapes& same, const std::filesystem::path& file,
                    const RunContext& context);

/// Writes each table as FOLDER/NAME.csv (RFC 4180, UTF-8, a header line). \throw InputError
void write_csv(const Collection& collection, const SameShapes& same, const std::filesystem::path& folder,
               const RunContext& context);

/// Writes a page that shows all items, and what it loads: index.html, items.js. It needs no server and no network.
/// Pictures are loaded as they come into view, from where they lie in the collection.
void write_gallery(const Collection& collection, const SameShapes& same, const std::filesystem::path& folder,
                   const RunContext& context);

}  // namespace orbifit::batch
