// Measures the force and torque on the hand: reads a recording, or lets the simulated hand mill the built-in
// tooth for two seconds and hold still for one. Prints all figures of a report, and writes them as a page.
//
//     ./measure_recording [RECORDING]

#include <cstdio>
#include <exception>
#include <filesystem>

#include <osteomill/recording/recording.h>
#include <osteomill/session/milling_entry.h>
#include <osteomill/study/metric_table.h>
#include <osteomill/study/metrics.h>
#include <osteomill/study/milling_trial.h>
#include <osteomill/study/page.h>
#include <osteomill/volume/bone_densities.h>
#include <osteomill/volume/builtin_tooth.h>

namespace {

// Runs the test of section 8.2 of the paper in simulated time, which gives the same ticks on every machine.
osteomill::Recording recorded_trial() {
  const osteomill::Volume bone(osteomill::builtin_tooth(), osteomill::kBuiltinToothIsovalue);
  osteomill::TrialSettings settings;
  settings.hand_and_device.script.milling_s = 2;
  settings.hand_and_device.script.holding_s = 1;
  osteomill::MillingTrial trial(bone, osteomill::estimate_densities(bone),
                                osteomill::place_entry(bone, settings.tool), settings);
  osteomill::Recording recording;
  recording.path = "the simulated hand";
  recording.description.algorithm = settings.algorithm.id;
  recording.description.tick_period_s = settings.tick_s;
  while (!trial.finished()) recording.records.push_back(trial.tick().record);
  return recording;
}

}  // namespace

int main(int argc, char** argv) try {
  const osteomill::Recording recording = argc > 1 ? osteomill::read_recording(argv[1]) : recorded_trial();
  const osteomill::RunMetrics metrics = osteomill::run_metrics(recording);

  osteomill::Table table{{"figure", recording.description.algorithm.label}, {}, true};
  for (const osteomill::Field<osteomill::RunMetrics>& field : osteomill::fields_of<osteomill::RunMetrics>()) {
    table.rows.push_back({osteomill::label_of(field), osteomill::shown(field.get(metrics))});
  }
  std::fputs(osteomill::plain_text(table).c_str(), stdout);

  const auto page = osteomill::write_page("measured", "figures.html", [&](const std::filesystem::path&) {
    return osteomill::Page{"What the hand felt", {{.title = recording.path.string(), .tables = {table}}}};
  });
  std::puts(page.c_str());
  return metrics.force_N.mean > 0 ? 0 : 1;
} catch (const std::exception& error) {  // an InputError names the file and the reason
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
