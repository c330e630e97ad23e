#include "builder/work_folder.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/positioned_file.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;

Result<std::string> text_in(const fs::path& path) {
  const Result<PositionedFile> file = PositionedFile::open(path);
  if (!file) return fail(file);
  std::string text(file->size(), ' ');
  if (Status status = file->read(0, std::as_writable_bytes(std::span(text))); !status) {
    return fail_about(path.string(), status);
  }
  return text;
}

/// The parts without a result, by what they have instead.
struct MissingResults {
  std::vector<size_t> absent;
  std::vector<size_t> foreign;
  std::vector<size_t> damaged;

  void add(size_t number, ErrorKind kind) {
    (kind == ErrorKind::kNotFound ? absent : kind == ErrorKind::kReplaced ? foreign : damaged).push_back(number);
  }
  [[nodiscard]] bool none() const { return absent.empty() && foreign.empty() && damaged.empty(); }
  [[nodiscard]] std::string text() const {
    std::string text;
    const auto say = [&text](const std::vector<size_t>& numbers, const char* what) {
      if (numbers.empty()) return;
      text += (text.empty() ? "" : "; ") + std::string(what) + as_ranges(numbers);
    };
    say(absent, "missing: ");
    say(foreign, "of another plan: ");
    say(damaged, "damaged: ");
    return text;
  }
};

const char* name_of(WorkStep step) {
  switch (step) {
    case WorkStep::kPart:
      return "part";
    case WorkStep::kSigns:
      return "signs";
    case WorkStep::kBlocks:
      return "blocks";
    case WorkStep::kMerge:
      break;
  }
  return "merge";
}

bool is_for_each_part(WorkStep step) {
  return step == WorkStep::kPart || step == WorkStep::kBlocks;
}

}  // namespace

fs::path plan_file(const fs::path& folder) {
  return folder / "plan";
}

fs::path part_count_file(const fs::path& folder) {
  return folder / "parts";
}

std::string as_ranges(std::span<const size_t> numbers) {
  std::string text;
  for (const PieceRun& run : runs_of({numbers.begin(), numbers.end()})) {
    text += (text.empty() ? "" : ", ") + std::to_string(run.first);
    if (run.count > 1) text += "-" + std::to_string(run.first + run.count - 1);
  }
  return text;
}

Result<WorkFolder> WorkFolder::open(const fs::path& folder, const std::string& program) {
  const fs::path path = plan_file(folder);
  const Result<std::string> text = text_in(path);
  const std::string remedy = "; run `surfcastd build-plan INPUT... --work " + folder.string() + "`";
  if (!text && text.error().kind == ErrorKind::kNotFound) {
    return fail(ErrorKind::kNotFound, folder.string() + ": holds no plan" + remedy);
  }
  if (!text) return fail(text);
  Result<BuildPlan> plan = read_plan(*text);
  if (!plan) return fail(plan.error().kind, path.string() + ": " + plan.error().message + remedy);
  if (plan->request.program != program) {
    return fail(ErrorKind::kUnsupported,
                path.string() + ": was made by version " + plan->request.program + ", and this is " + program + remedy);
  }
  return WorkFolder(folder, std::move(*plan));
}

Result<size_t> WorkFolder::index_of(size_t number) const {
  if (number >= 1 && number <= parts()) return number - 1;
  return fail(ErrorKind::kNotFound, plan_file(folder_).string() + ": has parts 1 to " + std::to_string(parts()) +
                                        ", and none of number " + std::to_string(number));
}

fs::path WorkFolder::file(WorkStep step, size_t part) const {
  const std::string name = name_of(step);
  return folder_ / (is_for_each_part(step) ? name + "-" + std::to_string(part + 1) : name);
}

WorkOwner WorkFolder::owner(WorkStep step, size_t part) const {
  return {plan_.digest, step, is_for_each_part(step) ? part + 1 : 0};
}

std::string WorkFolder::command(WorkStep step, const std::string& part) const {
  const std::string number = is_for_each_part(step) ? " " + part : "";
  return "`surfcastd build-" + std::string(name_of(step)) + number + " --work " + folder_.string() + "`";
}

bool WorkFolder::is_done(WorkStep step, size_t part) const {
  const Result<WorkFile> result = WorkFile::open(file(step, part), owner(step, part));
  return result && result->check().has_value();
}

Result<WorkFileWriter> WorkFolder::create(WorkStep step, size_t part) const {
  return WorkFileWriter::create(file(step, part), owner(step, part));
}

Result<WorkFile> WorkFolder::result(WorkStep step, size_t part) const {
  Result<WorkFile> found = WorkFile::open(file(step, part), owner(step, part));
  if (found) return found;
  const bool absent = found.error().kind == ErrorKind::kNotFound;
  const std::string what = absent ? file(step, part).string() + ": is missing" : found.error().message;
  return fail(found.error().kind, what + "; run " + command(step, std::to_string(part + 1)));
}

Status WorkFolder::check_all(WorkStep step) const {
  MissingResults missing;
  for (size_t part = 0; part < parts(); ++part) {
    const Result<WorkFile> found = WorkFile::open(file(step, part), owner(step, part));
    if (!found) missing.add(part + 1, found.error().kind);
  }
  if (missing.none()) return {};
  return fail(ErrorKind::kNotFound, folder_.string() + ": of the " + std::to_string(parts()) + " files " +
                                        name_of(step) + "-K, " + missing.text() + "; run " + command(step, "K") +
                                        " for each");
}

}  // namespace surfcast::builder
