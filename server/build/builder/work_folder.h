#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "base/result.h"
#include "builder/build_plan.h"
#include "builder/work_file.h"

namespace surfcast::builder {

/// The folder of a build in parts: its plan and the results of its steps. Parts count from 0 here, and from 1 in names
/// and messages.
class WorkFolder {
 public:
  /// Reads the plan. Fails if there is none, or if it is damaged or of another version of the program.
  static Result<WorkFolder> open(const std::filesystem::path& folder, const std::string& program);

  [[nodiscard]] const BuildPlan& plan() const { return plan_; }
  [[nodiscard]] size_t parts() const { return plan_.parts.size(); }
  /// The index of a part by its number. Fails if the plan has none of this number.
  [[nodiscard]] Result<size_t> index_of(size_t number) const;

  [[nodiscard]] std::filesystem::path file(WorkStep step, size_t part = 0) const;
  /// Whether the result of a step is there and whole.
  [[nodiscard]] bool is_done(WorkStep step, size_t part = 0) const;
  [[nodiscard]] Result<WorkFileWriter> create(WorkStep step, size_t part = 0) const;
  /// The result of an earlier step. An error names the step to run.
  [[nodiscard]] Result<WorkFile> result(WorkStep step, size_t part = 0) const;
  /// Fails unless all parts have a result of this step, and names those that have none.
  [[nodiscard]] Status check_all(WorkStep step) const;

 private:
  WorkFolder(std::filesystem::path folder, BuildPlan plan) : folder_(std::move(folder)), plan_(std::move(plan)) {}
  [[nodiscard]] WorkOwner owner(WorkStep step, size_t part) const;
  [[nodiscard]] std::string command(WorkStep step, const std::string& part) const;

  std::filesystem::path folder_;
  BuildPlan plan_;
};

/// Where the plan of a folder is.
std::filesystem::path plan_file(const std::filesystem::path& folder);
/// Where the number of its parts is, for schedulers.
std::filesystem::path part_count_file(const std::filesystem::path& folder);

/// Ascending numbers as text: "3, 7-9".
std::string as_ranges(std::span<const size_t> numbers);

}  // namespace surfcast::builder
