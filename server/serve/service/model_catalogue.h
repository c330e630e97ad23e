#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/model_file.h"
#include "object_store/object_store.h"
#include "service/model_source.h"

namespace surfcast::service {

/// A model file and the name it is served under.
struct NamedModel {
  std::string name;
  std::filesystem::path path;            ///< or the URL of an object in a store
  std::shared_ptr<const void> in_use{};  ///< held for as long as the file may be opened: whoever keeps it from removal
  std::shared_ptr<const model::ModelFile> opened{};  ///< the model, if it has been opened already
  /// Opens a scan that is shown in place, which errors call by the argument. Empty: the path is that of a model.
  std::function<Result<model::ModelFile>(const std::string& shown)> open_in_place{};
};

/// Model files by name: scans, whose models come later and are replaced by better ones, individual files, and the
/// current content of folders ("NAME.surf"). A scan or an individual file hides a file of the same name in a folder,
/// and an earlier folder hides a later one; models in folders of stores come last. A file is opened at the first
/// request, and again after it has been replaced. A folder is read again after it has changed. A name such as "a+b"
/// that no model has is that of several models, shown as one.
class ModelCatalogue : public ModelSource {
 public:
  /// Joined models that are kept. One takes about 200 bytes for each block of its members.
  static constexpr size_t kKeptJoins = 16;

  /// `store` opens models whose paths are URLs, and outlives them; needed only where there are such.
  ModelCatalogue(std::vector<NamedModel> files, std::vector<std::filesystem::path> folders,
                 const object_store::ObjectStore* store = nullptr);

  /// An edition of a scan's model.
  struct Edition {
    std::shared_ptr<const model::ModelFile> model;
    bool preview = false;
    std::shared_ptr<const void> in_use{};  ///< as in NamedModel
  };
  /// Called after every change of a scan or of a file that views show, from the thread that changed or noticed it.
  /// `published`: there is another edition.
  using Changed = std::function<void(bool published)>;

  /// Set it before the first scan is added.
  void on_change(Changed changed) { changed_ = std::move(changed); }
  /// Adds a scan whose model will be published. False if there is a file or scan of that name.
  [[nodiscard]] bool add_scan(const std::string& name);
  /// Whether there is a file or a scan of that name, or of each that it joins. Unlike `names`, counts scans that
  /// failed.
  [[nodiscard]] bool has(const std::string& name) const;
  /// How far a scan is: kWaiting, kBuilding or kFailed. Of a scan that was published, kFailed leaves the preview.
  void note(const ScanStatus& status);
  /// Adds the next edition. The one before it stays for views that show it, until there is another one.
  void publish(const std::string& name, Edition edition);

  /// Sets the models in folders of stores: their URLs by name. False if they were set to the same before.
  bool set_stored(std::map<std::string, std::filesystem::path> models);

  /// The models of stores that are open: somebody has to find out now and then whether they have been replaced.
  [[nodiscard]] std::vector<std::shared_ptr<const model::ModelFile>> opened_in_stores() const;

  /// Whether files that views show have been replaced: then they have another edition, and `on_change` is called.
  void look_for_replaced();

  /// Closes the files that are not there any more. They stay open for whoever still uses them.
  void close_removed() const;

  [[nodiscard]] std::vector<std::string> names() const override;
  [[nodiscard]] std::vector<ScanStatus> scans() const override;
  [[nodiscard]] bool awaited(const std::string& served_name) const override;
  [[nodiscard]] uint64_t edition(const std::string& served_name) const override;
  /// True for models of stores and for scans in place, by what is known of the folders since they were last read.
  [[nodiscard]] bool remote(const std::string& served_name) const override;
  /// The edition of a scan's model, or the newest one if it is 0 or gone. Files, and models that are joined, have their
  /// newest edition only.
  [[nodiscard]] Result<Edition> open_edition(const std::string& name, uint64_t edition) const;
  [[nodiscard]] Result<ModelDescription> describe(const std::string& name) const override;
  [[nodiscard]] Result<std::shared_ptr<const model::ModelFile>> open(const std::string& name) const override;

 private:
  struct Opened {
    std::filesystem::path path;
    std::filesystem::file_time_type written;
    std::shared_ptr<const model::ModelFile> model;
  };

  /// Models that are shown as one.
  struct Joined {
    std::vector<std::shared_ptr<const model::ModelFile>> members;
    std::shared_ptr<const model::ModelFile> model;
    uint64_t used = 0;  ///< the higher, the later
  };

  /// A file that views show, as it was when its edition was asked for or looked for last.
  struct Shown {
    std::filesystem::path path;
    std::filesystem::file_time_type written;
    uint64_t edition = 1;
  };

  struct Scan {
    ScanStatus status;
    bool complete = false;
    uint64_t edition = 0;  ///< number of `newest`
    Edition newest;
    Edition former;
  };

  /// What a folder holds, and whether that can be told from its time of modification: a change within the resolution
  /// of the clock of a file system does not show there.
  struct Listing {
    std::filesystem::file_time_type written;
    bool settled = false;
    std::map<std::string, std::filesystem::path> models;
  };

  [[nodiscard]] const Listing& listing_of(const std::filesystem::path& folder) const;
  [[nodiscard]] std::map<std::string, std::filesystem::path> find_all() const;
  [[nodiscard]] Result<model::ModelFile> open_path(const std::string& name, const std::string& shown,
                                                   const std::filesystem::path& path) const;
  [[nodiscard]] std::filesystem::path find(const std::string& name) const;
  [[nodiscard]] bool has_alone(const std::string& name) const;
  [[nodiscard]] bool known_alone(const std::string& name) const;
  using IsOne = bool (ModelCatalogue::*)(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> members_of(const std::string& served_name, IsOne is_one) const;
  [[nodiscard]] std::vector<std::string> known_members_of(const std::string& served_name) const;
  [[nodiscard]] Result<Edition> open_alone(const std::string& name, uint64_t edition) const;
  [[nodiscard]] Result<Edition> open_joined(const std::vector<std::string>& names) const;
  [[nodiscard]] Result<std::shared_ptr<const model::ModelFile>> join(
      const std::vector<std::string>& names, std::vector<std::shared_ptr<const model::ModelFile>> models) const;
  [[nodiscard]] Result<std::shared_ptr<const model::ModelFile>> open_file(const std::string& name) const;
  [[nodiscard]] uint64_t edition_of_file(const std::string& name) const;

  Changed changed_ = [](bool) {};
  std::vector<NamedModel> files_;
  std::vector<std::filesystem::path> folders_;
  const object_store::ObjectStore* store_;
  mutable std::mutex mutex_;
  std::map<std::string, Scan> scans_;                          ///< by name
  mutable std::map<std::string, Opened> opened_;               ///< by name
  mutable std::map<std::string, Shown> shown_;                 ///< by name
  mutable std::map<std::vector<std::string>, Joined> joined_;  ///< by the names of the members
  mutable uint64_t joins_ = 0;                                 ///< uses of them
  mutable std::mutex listing_mutex_;                           ///< guards what follows; nothing else is locked under it
  mutable std::map<std::filesystem::path, Listing> listings_;
  std::map<std::string, std::filesystem::path> stored_;
};

}  // namespace surfcast::service
