#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <vector>

#include <fmt/core.h>
#include <malloc.h>
#include <unistd.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_entry.h"
#include "osteomill/session/simulated_operator.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/density_grid.h"

#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr double kTick_s = 1e-3;
constexpr double kCycle_s = 20;

double resident_MiB() {
  // Returns freed memory to the system, so that it is not counted.
  ::malloc_trim(0);
  std::ifstream in("/proc/self/statm");
  double all_pages = 0, pages = 0;
  in >> all_pages >> pages;
  return pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

// Figures of one part of the session.
struct Stretch {
  double force_sum_N = 0, force_max_N = 0, torque_max_Nmm = 0, tool_offset_max_mm = 0, energy_max_Nmm = 0;
  std::size_t ticks = 0;
  bool finite = true;

  void add(const TickRecord& r) {
    ++ticks;
    force_sum_N += r.wrench.force_N.norm();
    force_max_N = std::max(force_max_N, r.wrench.force_N.norm());
    torque_max_Nmm = std::max(torque_max_Nmm, r.wrench.torque_Nmm.norm());
    tool_offset_max_mm = std::max(tool_offset_max_mm, (r.X_WT.position_mm - r.X_WD.position_mm).norm());
    energy_max_Nmm = std::max(energy_max_Nmm, r.energy_given_Nmm);
    finite = finite && is_finite(r.X_WT) && r.wrench.force_N.allFinite() && r.wrench.torque_Nmm.allFinite() &&
             r.burr_force_W_N.allFinite() && std::isfinite(r.removed_mm3);
  }
};

// Mills a bone and holds against it in cycles, each with a hand drawn by its seed. Places the tool at
// the entry before each cycle; after it changes the algorithm, undoes the cycle, or continues.
class Soak {
 public:
  Soak(const Volume& scan, const std::filesystem::path& path)
      : scan_(scan),
        scan_hash_(fingerprint_of(scan.grid())),
        settings_{.densities = estimate_densities(scan)},
        entry_(place_entry(scan, settings_.setup.tool)),
        bone_(std::make_shared<Volume>(scan)) {
    settings_.setup.tick_s = kTick_s;
    begin("line-proxy", {}, 0);
    recorder_ = std::make_unique<Recorder>(path, description());
  }

  // Runs a cycle. `seed` draws the hand and the action after the cycle.
  void cycle(unsigned seed, Stretch& stretch, std::vector<TickRecord>* kept = nullptr) {
    std::mt19937 random(seed);
    OperatorSettings person;
    person.seed = seed;
    person.hand = random_hand(seed);
    person.script.milling_s = 0.6 * kCycle_s;
    person.script.holding_s = 0.4 * kCycle_s;
    SimulatedOperator hand(person, settings_.setup.tool, entry_);
    const Volume before = *bone_;
    const double removed_before_mm3 = session_->removed_mm3();
    session_->place();
    while (!hand.finished()) {
      TickRecord record = session_->tick(hand, {.time_s = time_s_, .dt_s = kTick_s});
      record.session = number_;
      time_s_ += kTick_s;
      stretch.add(record);
      recorder_->push_waiting(record);
      if (kept != nullptr) kept->push_back(record);
    }
    if (random() % 3 == 0) {
      switch_to(bone_, all_algorithms()[random() % all_algorithms().size()].id.name, session_->removed_mm3(),
                session_->handover());
    } else if (random() % 2 == 0) {
      switch_to(std::make_shared<Volume>(before), algorithm_, removed_before_mm3, session_->handover());
    }
  }

  // Returns the memory that must not grow: that of one algorithm on the current bone.
  double memory_MiB() {
    switch_to(bone_, "line-proxy", session_->removed_mm3(), session_->handover());
    return resident_MiB();
  }
  // Restarts from the scan, without any state of the last session.
  void reset() { switch_to(std::make_shared<Volume>(scan_), "line-proxy", 0, {}); }
  void close() { recorder_->close(); }
  double time_s() const { return time_s_; }

 private:
  void begin(const std::string& algorithm, const SessionHandover& before, double removed_mm3) {
    algorithm_ = algorithm;
    settings_.setup.algorithm = algorithm_named(algorithm);
    session_ = std::make_unique<MillingSession>(bone_, settings_.densities, settings_.setup);
    session_->count_removed_from(removed_mm3);
    session_->resume_from(before);
  }

  void switch_to(std::shared_ptr<Volume> bone, const std::string& algorithm, double removed_mm3,
                 const SessionHandover& left) {
    bone_ = std::move(bone);
    begin(algorithm, left, removed_mm3);
    recorder_->begin_session(
        ++number_, {description(), left, removed_mm3, differing_blocks(bone_->grid(), scan_.grid()), ""});
  }

  RunDescription description() const {
    return describe_run(scan_, {"soak", scan_hash_}, settings_, session_->algorithm().sample_point_count());
  }

  const Volume& scan_;
  std::uint64_t scan_hash_;
  SessionSettings settings_;
  MillingEntry entry_;
  std::shared_ptr<Volume> bone_;
  std::string algorithm_;
  std::unique_ptr<MillingSession> session_;
  std::unique_ptr<Recorder> recorder_;
  std::uint32_t number_ = 0;
  double time_s_ = 0;
};

bool is_same_tick(const TickRecord& a, const TickRecord& b) {
  return a.wrench.force_N == b.wrench.force_N && a.wrench.torque_Nmm == b.wrench.torque_Nmm &&
         a.X_WT.position_mm == b.X_WT.position_mm &&
         a.X_WT.orientation.coeffs() == b.X_WT.orientation.coeffs() && a.removed_mm3 == b.removed_mm3 &&
         a.energy_given_Nmm == b.energy_given_Nmm && a.bone_hash == b.bone_hash;
}

}  // namespace

Section soak(const Bones& bones, const Effort& effort) {
  Section section{
      "A long session",
      fmt::format(
          "Must hold over {:.0f} minutes of simulated session (milling and holding in turns, by a hand "
          "that is drawn again for each cycle, with changes of the algorithm and undone cuts): memory "
          "(measured with line-proxy) grows by at most 5 % after the first sixth; all values are "
          "finite, and force and torque are within the device's 20 N and 500 N mm; the last cycle, "
          "which repeats the first, gives the same bits; the recording can be read and replays to the "
          "bit. On {}.",
          effort.soak_min, bones.tooth_name),
      {"minutes", "mean force, N", "force, torque max, N, N mm", "tool from device, mm", "energy given, N mm",
       "memory, MiB", ""},
      {},
      {}};
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("osteomill-soak-{}.h5", ::getpid());
  Soak soak(bones.tooth, path);
  constexpr int kStretches = 6;
  const auto cycles =
      std::max<unsigned>(1, static_cast<unsigned>(std::lround(60 * effort.soak_min / kCycle_s / kStretches)));
  std::vector<TickRecord> first, last;
  double memory_MiB = 0;
  for (int n = 0; n < kStretches; ++n) {
    Stretch stretch;
    const double from_s = soak.time_s();
    for (unsigned c = 0; c < cycles; ++c) {
      const bool is_last = n + 1 == kStretches && c + 1 == cycles;
      if (is_last) {
        soak.reset();
        last.clear();
      }
      soak.cycle(is_last ? 1 : 1 + static_cast<unsigned>(n) * cycles + c, stretch,
                 n + c == 0 ? &first
                 : is_last  ? &last
                            : nullptr);
    }
    // Takes the last cycle's memory now, so that it counts from the first part on.
    if (n == 0) last = first;
    const double now_MiB = soak.memory_MiB();
    if (n == 0) memory_MiB = now_MiB;
    section.add({fmt::format("{:.0f} to {:.0f}", from_s / 60, soak.time_s() / 60),
                 figure(stretch.force_sum_N / static_cast<double>(stretch.ticks)),
                 figure(stretch.force_max_N) + ", " + figure(stretch.torque_max_Nmm),
                 figure(stretch.tool_offset_max_mm), figure(stretch.energy_max_Nmm), figure(now_MiB)},
                stretch.finite && stretch.force_max_N <= 20 + 1e-9 && stretch.torque_max_Nmm <= 500 + 1e-9 &&
                    now_MiB <= 1.05 * memory_MiB);
  }
  soak.close();
  const bool repeats =
      first.size() == last.size() && std::equal(first.begin(), first.end(), last.begin(), is_same_tick);
  section.add({"the first cycle again", "", repeats ? "the same bits" : "other bits", "", "", ""}, repeats);
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  const Recording recording = read_recording(path);
  const Verification verified = verify_recording(bones.tooth, recording);
  section.add(
      {"its recording", fmt::format("{} ticks, {} sessions", verified.ticks, recording.sessions.size()),
       verified.difference ? verified.difference->what : "replays to the bit",
       fmt::format("{:.3g} GB an hour", bytes / 1e9 / (soak.time_s() / 3600)), "", ""},
      !verified.difference && recording.complete);
  std::filesystem::remove(path);
  return section;
}

}  // namespace osteomill::verification
