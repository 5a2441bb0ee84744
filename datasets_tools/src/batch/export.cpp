#include "batch/export.h"

#include <functional>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>
#include <sqlite3.h>
#include <unistd.h>

#include "orbifit/model/errors.h"

#include "batch/item_names.h"
#include "files/file.h"

namespace orbifit::batch {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

using Row = std::vector<json>;
using RowWriter = std::function<void(std::size_t table, const Row& row)>;

const json& get(const json& from, std::initializer_list<const char*> keys) {
  static const json none;
  const json* value = &from;
  for (const char* key : keys) {
    if (!value->is_object() || !value->contains(key)) return none;
    value = &value->at(key);
  }
  return *value;
}

std::string id_or_nothing(const Collection& collection, const std::vector<std::size_t>& firsts, std::size_t item) {
  return firsts[item] == item ? "" : collection.record(firsts[item]).id;
}

json null_if_empty(const std::string& text) {
  return text.empty() ? json(nullptr) : json(text);
}

std::size_t count_faces(const json& runs) {
  std::size_t faces = 0;
  if (!runs.is_array()) return 0;
  for (const json& run : runs) faces += run.at(1).get<std::size_t>();
  return faces;
}

// The regions and patterns of an annotation, as it stands in the collection.
void write_annotation_rows(const Collection& collection, const Record& record, const json& summary,
                           const RowWriter& write) {
  for (const char* kind : {"+annotation.json", ".json"}) {
    const fs::path file = collection.folder() / place_of(record.id, kind);
    if (!fs::exists(file)) continue;
    const json annotation = json::parse(read_file(file), nullptr, false);
    if (get(annotation, {"format"}) != "symmetry-annotation") continue;
    std::size_t number = 0;
    for (const json& region : annotation.at("regions")) {
      write(1, {record.id, region.at("id"), get(region, {"name"}), region.at("group"), get(region, {"parent"}),
                count_faces(get(region, {"faces"})),
                summary.contains("regions") && summary["regions"].size() == annotation["regions"].size()
                    ? get(summary["regions"][number], {"area"})
                    : json(nullptr),
                region.at("elements").size(), get(region, {"residual", "rms"}), get(region, {"residual", "max"})});
      ++number;
    }
    for (const json& pattern : annotation.at("patterns")) {
      write(2, {record.id, pattern.at("id"), get(pattern, {"name"}), pattern.at("kind"), pattern.at("instances").size(),
                get(pattern, {"residual", "rms"}), get(pattern, {"residual", "max"})});
    }
    return;
  }
}

void write_rows(const Collection& collection, const SameShapes& same, const RunContext& context,
                const RowWriter& write) {
  for (std::size_t i = 0; i < collection.size(); ++i) {
    context.progress("export", static_cast<double>(i) / static_cast<double>(collection.size()));
    const Record record = collection.record(i);
    const json summary = json::parse(record.summary);
    const auto length = [&](const char* key) { return summary.contains(key) ? summary[key].size() : 0; };
    write(0, {record.id, to_string(record.status), null_if_empty(record.message), record.seconds, record.peak_memory,
              record.hash ? json(record.hash->text()) : json(nullptr), get(summary, {"mesh", "file"}),
              get(summary, {"mesh", "hash"}), get(summary, {"mesh", "vertices"}), get(summary, {"mesh", "faces"}),
              get(summary, {"mesh", "diagonal"}), length("regions"), length("patterns"),
              null_if_empty(id_or_nothing(collection, same.same_file, i)),
              null_if_empty(id_or_nothing(collection, same.same_shape, i)), get(summary, {"fit", "inlier_fraction"}),
              get(summary, {"fit", "hidden_fraction"}), get(summary, {"fit", "confidence"})});
    if (record.status == Status::ok) write_annotation_rows(collection, record, summary, write);
  }
}

class Database {
 public:
  explicit Database(const fs::path& file) : file_(file) {
    if (sqlite3_open(file.c_str(), &handle_) != SQLITE_OK) refuse();
  }
  ~Database() {
    for (sqlite3_stmt* statement : inserts_) sqlite3_finalize(statement);
    sqlite3_close(handle_);
  }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  Database(Database&&) = delete;
  Database& operator=(Database&&) = delete;

  void run(const std::string& sql) {
    if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) refuse();
  }

  void prepare_insert(const std::string& sql) {
    if (sqlite3_prepare_v2(handle_, sql.c_str(), -1, &inserts_.emplace_back(nullptr), nullptr) != SQLITE_OK) refuse();
  }

  void insert(std::size_t table, const Row& row) {
    sqlite3_stmt* statement = inserts_[table];
    for (std::size_t c = 0; c < row.size(); ++c) {
      const json& value = row[c];
      const int place = static_cast<int>(c) + 1;
      if (value.is_number_integer()) {
        sqlite3_bind_int64(statement, place, value.get<std::int64_t>());
      } else if (value.is_number()) {
        sqlite3_bind_double(statement, place, value.get<double>());
      } else if (value.is_string()) {
        const auto& text = value.get_ref<const std::string&>();
        sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
      } else {
        sqlite3_bind_null(statement, place);
      }
    }
    if (sqlite3_step(statement) != SQLITE_DONE) refuse();
    sqlite3_reset(statement);
  }

 private:
  [[noreturn]] void refuse() {
    throw InputError(file_.string(), "", std::string("cannot be written: ") + sqlite3_errmsg(handle_));
  }

  fs::path file_;
  sqlite3* handle_ = nullptr;
  std::vector<sqlite3_stmt*> inserts_;
};

std::string create_statement(const TableSchema& table) {
  std::string sql = std::string("CREATE TABLE ") + table.name + " (";
  for (const Column& column : table.columns)
    sql += std::string(&column == table.columns.data() ? "" : ", ") + "\"" + column.name + "\" " + column.type;
  return sql + (table.columns.front().name == std::string("id")
                    ? ", PRIMARY KEY (id))"
                    : ", PRIMARY KEY (item, id), FOREIGN KEY (item) REFERENCES items (id))");
}

std::string csv_field(const json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const auto& text = value.get_ref<const std::string&>();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

const std::vector<TableSchema>& export_tables() {
  static const std::vector<TableSchema> tables{{"items",
                                                {{"id", "TEXT"},
                                                 {"status", "TEXT"},
                                                 {"message", "TEXT"},
                                                 {"seconds", "REAL"},
                                                 {"peak_memory", "INTEGER"},
                                                 {"hash", "TEXT"},
                                                 {"mesh", "TEXT"},
                                                 {"mesh_hash", "TEXT"},
                                                 {"vertices", "INTEGER"},
                                                 {"faces", "INTEGER"},
                                                 {"diagonal", "REAL"},
                                                 {"regions", "INTEGER"},
                                                 {"patterns", "INTEGER"},
                                                 {"same_file_as", "TEXT"},
                                                 {"same_shape_as", "TEXT"},
                                                 {"fit_inlier_fraction", "REAL"},
                                                 {"fit_hidden_fraction", "REAL"},
                                                 {"fit_confidence", "REAL"}}},
                                               {"regions",
                                                {{"item", "TEXT"},
                                                 {"id", "INTEGER"},
                                                 {"name", "TEXT"},
                                                 {"group", "TEXT"},
                                                 {"parent", "INTEGER"},
                                                 {"faces", "INTEGER"},
                                                 {"area_fraction", "REAL"},
                                                 {"elements", "INTEGER"},
                                                 {"residual_rms", "REAL"},
                                                 {"residual_max", "REAL"}}},
                                               {"patterns",
                                                {{"item", "TEXT"},
                                                 {"id", "INTEGER"},
                                                 {"name", "TEXT"},
                                                 {"kind", "TEXT"},
                                                 {"instances", "INTEGER"},
                                                 {"residual_rms", "REAL"},
                                                 {"residual_max", "REAL"}}}};
  return tables;
}

void write_database(const Collection& collection, const SameShapes& same, const fs::path& file,
                    const RunContext& context) {
  UnfinishedFile unfinished(file);
  {
    Database database(unfinished.name());
    database.run("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA user_version = 1; BEGIN");
    for (const TableSchema& table : export_tables()) {
      database.run(create_statement(table));
      std::string places = "?";
      for (std::size_t c = 1; c < table.columns.size(); ++c) places += ", ?";
      database.prepare_insert(std::string("INSERT INTO ") + table.name + " VALUES (" + places + ")");
    }
    write_rows(collection, same, context, [&](std::size_t table, const Row& row) { database.insert(table, row); });
    database.run("CREATE INDEX regions_by_group ON regions (\"group\"); COMMIT");
  }
  unfinished.complete();
}

void write_csv(const Collection& collection, const SameShapes& same, const fs::path& folder,
               const RunContext& context) {
  std::vector<std::string> texts;
  const auto append = [&](std::size_t table, const Row& row) {
    for (std::size_t c = 0; c < row.size(); ++c) texts[table] += (c == 0 ? "" : ",") + csv_field(row[c]);
    texts[table] += "\r\n";
  };
  for (const TableSchema& table : export_tables()) {
    Row header;
    for (const Column& column : table.columns) header.emplace_back(column.name);
    texts.emplace_back();
    append(texts.size() - 1, header);
  }
  write_rows(collection, same, context, append);
  std::error_code code;
  fs::create_directories(folder, code);
  for (std::size_t t = 0; t < texts.size(); ++t) {
    write_file(folder / (std::string(export_tables()[t].name) + ".csv"), texts[t]);
  }
}

}  // namespace orbifit::batch
