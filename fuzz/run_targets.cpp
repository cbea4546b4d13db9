#include <algorithm>

#include <CLI/CLI.hpp>
#include <hdf5.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/recording.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/study/study_slices.h"

#include "app/config_file.h"
#include "app/milling_options.h"
#include "app/option_checks.h"
#include "fuzz/targets.h"
#include "recording_file.h"

namespace osteomill::fuzzing {

namespace fs = std::filesystem;

namespace {

void read_trajectory_of(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "poses.csv", bytes);
  read_trajectory(folder / "poses.csv");
}

std::vector<std::string> trajectory_seeds(const fs::path&) {
  return {"time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n0,0,0,30,1,0,0,0,0\n0.001,0,0,30,1,0,0,0,1\n",
          "milling,time_s,qw,qx,qy,qz,x_mm,y_mm,z_mm,other\n1,0.5,0,1,0,0,1e-3,-2,3,text\n"};
}

void read_config(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "c.toml", bytes);
  CLI::App program;
  CLI::App* const command = program.add_subcommand("replay", "");
  app::MillingOptions milling;
  bool flag = false;
  double number = 0;
  std::string text;
  command->add_flag("--quiet", flag);
  command->add_option("--seconds", number);
  command->add_option("--out", text);
  app::add_milling_options(*command, milling);
  app::check_values(*command);
  program.parse(std::vector<std::string>{(folder / "c.toml").string(), "--config", "replay"});
  app::apply_config_file(*command);
}

std::vector<std::string> config_seeds(const fs::path&) {
  return {
      "quiet = true\nseconds = 1.5\nout = \"x\"\nburr-radius = 2\n[point-shell]\ndamping-time = 0\nscale "
      "= 2\n",
      "seconds = 2.5 # s\nout = '''a\nb'''\nset = ['point-shell.scale=2']\n"};
}

// Returns an unfinished recording, because the checksum of a finished one would reject every change.
std::string unfinished_recording(const fs::path& file) {
  RunDescription description;
  description.scan_name = "made up";
  description.dims = {8, 8, 8};
  description.algorithm = algorithm_named("point-shell").id;
  description.settings = {{"stiffness", 2.5, "N/mm"}, {"command_line", std::string("osteomill"), ""}};
  description.labels = {{3, "nerve", {255, 0, 0}, true}};
  TickRecord record;
  record.label_cuts[0] = {1, 0.5};
  {
    RecordingFile recording(file, description);
    const DensityGrid grid({.dims = description.dims}, std::vector<float>(512, 1));
    recording.begin_session({.bricks = {DensityBlock(grid, {0, 0, 0})}}, 0);
    recording.append(std::vector<TickRecord>(3, record));
    recording.add_picture("bone", std::vector<unsigned char>{1, 2, 3});
    recording.flush(0);
  }
  return read_bytes(file);
}

void read_recording_of(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "a.h5", bytes);
  read_recording(folder / "a.h5");
}

std::vector<std::string> recording_seeds(const fs::path& folder) {
  return {unfinished_recording(folder / "a.h5")};
}

StudyFolder study_in(const fs::path& folder) {
  return {.path = folder,
          .record = {.study_hash = 1,
                     .program_hash = 2,
                     .scans_from = "/here",
                     .trials = 3,
                     .trials_a_slice = 2,
                     .bones = {{"scan=a", 3}}}};
}

void read_study_of(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "study.h5", bytes);
  read_study_record(folder);
}

std::vector<std::string> study_seeds(const fs::path& folder) {
  write_study_record(folder, study_in(folder).record);
  return {read_bytes(folder / "study.h5")};
}

void read_slice_of(Bytes bytes, const fs::path& folder) {
  write_bytes(slice_path(folder, 0), bytes);
  study_status(study_in(folder));
}

std::vector<std::string> slice_seeds(const fs::path& folder) {
  const StudyFolder study = study_in(folder);
  Slice slice;
  for (std::size_t n = 0; n < 4; ++n) slice.rows.push_back({.trial = n / 2, .part = n % 2});
  write_slice(study, slice);
  return {read_bytes(slice_path(folder, 0))};
}

// Interprets the bytes as a sequence of instructions.
class Instructions {
 public:
  explicit Instructions(Bytes bytes) : bytes_(bytes) {}
  unsigned next() { return fill(1).front(); }
  std::vector<unsigned char> fill(std::size_t count) {
    std::vector<unsigned char> taken(count);
    const std::size_t there = std::min(count, bytes_.size());
    std::copy_n(bytes_.begin(), there, taken.begin());
    bytes_ = bytes_.subspan(there);
    return taken;
  }

 private:
  Bytes bytes_;
};

void change_attribute(hid_t object, const std::string& name, Instructions& orders) {
  const unsigned order = orders.next() % 8;
  if (order == 1) H5Adelete(object, name.c_str());
  if (order == 2) {
    // Recreates it with another type or length.
    H5Adelete(object, name.c_str());
    const hsize_t count = orders.next() % 4;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t types[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT64, H5T_C_S1, H5T_NATIVE_FLOAT};
    H5Aclose(H5Acreate2(object, name.c_str(), types[orders.next() % 4], space, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
  }
  if (order > 4) {
    const hid_t attribute = H5Aopen(object, name.c_str(), H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    H5Awrite(attribute, type, orders.fill(H5Aget_storage_size(attribute)).data());
    H5Tclose(type);
    H5Aclose(attribute);
  }
}

void change_column(hid_t file, const std::string& name, Instructions& orders) {
  const unsigned order = orders.next() % 8;
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  if (order == 1) H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  if (order == 2) {
    const hsize_t rows = orders.next() % 8;
    H5Dset_extent(dataset, &rows);
  }
  if (order > 4) {
    const hid_t type = H5Dget_type(dataset);
    const hid_t space = H5Dget_space(dataset);
    const auto values = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
    H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, orders.fill(values * H5Tget_size(type)).data());
    H5Sclose(space);
    H5Tclose(type);
  }
  H5Dclose(dataset);
}

std::vector<std::string> attributes_of(hid_t object) {
  std::vector<std::string> names;
  const auto keep = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep, &names);
  return names;
}

// Changes every attribute and column of a recording according to the bytes and updates its checksum, so that
// HDF5 itself reads a valid file.
void read_changed_recording(Bytes bytes, const fs::path& folder) {
  static const std::string whole = unfinished_recording(folder / "a.h5");
  write_bytes(folder / "a.h5", {reinterpret_cast<const unsigned char*>(whole.data()), whole.size()});
  Instructions orders(bytes);
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  struct Object {
    std::string name;
    bool is_dataset;
  };
  std::vector<Object> objects;
  const auto keep = [](hid_t, const char* name, const H5O_info_t* info, void* list) -> herr_t {
    static_cast<std::vector<Object>*>(list)->push_back({name, info->type == H5O_TYPE_DATASET});
    return 0;
  };
  H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, keep, &objects);
  for (const Object& one : objects) {
    const hid_t object = H5Oopen(file, one.name.c_str(), H5P_DEFAULT);
    for (const std::string& name : attributes_of(object)) change_attribute(object, name, orders);
    H5Oclose(object);
    if (one.is_dataset) change_column(file, one.name, orders);
  }
  H5Fclose(file);
  write_checksum(folder / "a.h5");
  read_recording(folder / "a.h5");
}

std::vector<std::string> recording_orders(const fs::path&) {
  return {std::string(200, '\0')};
}

}  // namespace

std::vector<Target> run_targets() {
  return {{"trajectory", read_trajectory_of, trajectory_seeds},
          {"config", read_config, config_seeds},
          {"recording", read_recording_of, recording_seeds},
          {"study", read_study_of, study_seeds},
          {"slice", read_slice_of, slice_seeds},
          {"recording-values", read_changed_recording, recording_orders}};
}

}  // namespace osteomill::fuzzing
