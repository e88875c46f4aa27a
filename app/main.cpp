// The command line: one verb per step of the flow, one study file, one output folder.
#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>
#include <iostream>
#include <string_view>

#include "app/command.h"
#include "app/command_line/exit_code.h"
#include "app/command_line/guarded.h"
#include "app/command_line/option_values.h"
#include "app/command_line/watch.h"
#include "app/sweep.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/text_stream.h"
#include "dense/blas.h"
#include "host/parallel.h"
#include "io/frf_file.h"
#include "show/new_output.h"
#include "show/version.h"
#include "study/problems.h"

namespace {

namespace app = chladni::app;
namespace show = chladni::show;
namespace study = chladni::study;

using enum app::ExitCode;
using app::guarded;

// In the order of the workflow. A new verb needs one line here.
constexpr const app::Command* kCommands[] = {
    &app::check_command,       &app::mesh_command,     &app::modes_command,
    &app::export_command,      &app::place_command,    &app::priors_command,
    &app::experiment_command,  &app::simulate_command, &app::identify_command,
    &app::interpolate_command, &app::observe_command,  &app::compare_command,
    &app::diagnose_command,    &app::study_command,
};

bool is_mute = false;  // whoever started the program closed its standard error

/// @throws OutOfResources  what was printed or warned of is not written whole
void require_output() {
  std::cout.flush();
  if (!std::cout) throw chladni::OutOfResources("cannot write to the standard output");
  if (!std::cerr && !is_mute) {
    throw chladni::OutOfResources("cannot write to the standard error: a warning is lost");
  }
}

/// The message, with the study's name in front if it is not there yet.
std::string with_file(const std::filesystem::path& file, const std::string& message) {
  return message.starts_with(file.string()) ? message : file.string() + ": " + message;
}

int run(const app::Command& command, const std::filesystem::path& file, show::Options options) {
  auto manner = show::manner_of_stderr(options.quiet);
  manner.all = options.all;
  show::Talk talk(std::cerr, manner);
  chladni::TextWriter json;  // printed once it is known whether the verb ends well
  const app::ErrorStyle style{.excerpts = !options.quiet, .json = options.json, .result = &json};
  const auto work = [&]() -> int {
    if (command.name == "check" && chladni::io::is_measured_file(file)) {
      return app::check_data(file, options, std::cout);
    }
    if (options.threads > 0) chladni::set_thread_count(options.threads);
    const auto study = study::read_study(file, options.allowed);
    std::ostream& results = style.json ? json : std::cout;
    show::Run run(study, std::move(options), results, talk);
    try {
      command.run(study, run);
      run.finish_pictures();
      chladni::throw_if_interrupted();
    } catch (const chladni::InvalidInput& e) {
      throw chladni::InvalidInput(with_file(file, e.what()));
    }
    std::cout << json.view();
    require_output();
    return kDone;
  };
  return guarded(talk, work, style);
}

// As `run`, with --watch again and again.
int run_or_watch(const app::Command& command, const std::filesystem::path& file,
                 const show::Options& options) {
  if (!options.watch) return run(command, file, options);
  auto manner = show::manner_of_stderr(options.quiet);
  manner.all = true;  // each change is told
  show::Talk talk(std::cerr, manner);
  std::vector<std::filesystem::path> known;
  const auto folder = options.folder.empty() ? std::filesystem::path("out") : options.folder;
  const app::Watch watch{
      .files =
          [&] {
            const auto files = study::files_of(file, options.allowed);
            if (files.size() > 1 || known.empty()) known = files;  // one: it cannot be read now
            return known;
          },
      .run =
          [&] {
            std::cout.clear();  // of an earlier run
            return run(command, file, options);
          },
      .own =
          [&](const std::filesystem::path& one) { return app::is_written(command, folder, one); },
      .note = [&](const std::string& line) { talk.note(line); }};
  return guarded(talk, [&] { return app::run_at_each_change(watch); });
}

/// Options of the verbs that may solve.
void add_solution_options(CLI::App& verb, const app::Command& command, show::Options& options) {
  const auto is_one_of = [&](const auto&... names) { return ((command.name == names) || ...); };
  verb.add_option("--engine", options.engine,
                  "what starts the ranks that find the modes: \"mpiexec -n 4\"");
  verb.add_option("--memory-limit", options.memory_limit_gb,
                  "[GB] of a solution in this process, and of recordings [what is free]")
      ->transform(CLI::Validator(app::in_gigabytes, ""));
  verb.add_flag("!--no-certificate", options.certificate, "do not count the modes by inertia");
  if (is_one_of("check")) {
    verb.add_flag("--expect", options.expect, "compute, and compare with what the study expects");
    verb.add_option("--unit", options.unit,
                    "of measured responses that do not state it: m, m/s^2, g, um/V");
    verb.add_option("--sample-time", options.sample_time_s, "[s] of recordings without a time")
        ->transform(CLI::Validator(app::in_seconds, ""));
  }
  if (is_one_of("identify", "interpolate", "study")) {
    verb.add_flag("--keep-best", options.keep_best,
                  "Ctrl-C stops a fit, and its best so far is written");
  }
  if (is_one_of("modes", "study")) {
    verb.add_option("--animate", options.animate, "mode whose motion is left as modes.pvd")
        ->check(CLI::Range(1, 1'000'000));
  }
}

void add_options(CLI::App& verb, const app::Command& command, std::filesystem::path& file,
                 show::Options& options) {
  verb.add_option("STUDY", file,
                  command.name == "check" ? "the study, a .toml file, or measured data: .csv, "
                                            ".uff, .unv, .mat"
                                          : "the study, a .toml file")
      ->required();
  verb.add_option("-o,--output", options.folder, "folder for the results [out/<study name>]");
  verb.add_option("--threads", options.threads, "threads [physical cores]")
      ->check(CLI::Range(1, 1024));
  verb.add_option("--seed", options.seed, "seed of everything random [the study's, or 1]")
      ->check(CLI::Range(0LL, 4294967295LL));
  verb.add_option("--allow-outside", options.allowed,
                  "absolute folder from which the study may read files")
      ->check(CLI::ExistingDirectory);
  verb.add_flag("--quiet", options.quiet, "no notes and no progress; warnings and errors still");
  verb.add_flag("--all", options.all, "every table and warning, not only what matters first");
  verb.add_flag("--json", options.json, "the result as JSON on the standard output");
  verb.add_flag("--watch", options.watch, "run again at each change of a file that is read");
  verb.add_flag("--reproducible", options.reproducible, "no wall times in the results");
  if (command.name != "check") {
    verb.add_flag("!--no-pictures", options.pictures, "paint nothing");
    verb.add_flag("--svg", options.vectors, "leave plots also as SVG, for papers");
  }
  verb.add_flag("!--no-cache", options.cache,
                "mesh and solve anew, whatever earlier runs have kept, and keep nothing");
  if (command.name != "mesh" && command.name != "export") {
    add_solution_options(verb, command, options);
  }
}

struct OtherVerbs {
  std::string what, unit;
  std::filesystem::path from, to;
  bool force = false, hdf5 = false, clear = false, json = false;
  app::NewStudy fresh;
  app::Figures figures;
};

void add_figure_verb(CLI::App& cli, app::Figures& asked, show::Talk& talk, int& status) {
  auto* verb = cli.add_subcommand("figure", "figures for a paper from results, solving nothing");
  verb->add_option("RESULTS", asked.results, "a folder that a verb left, or a result within it")
      ->required();
  verb->add_option("NAME", asked.names, "the figures to draw [all]");
  verb->add_option("-o,--output", asked.output, "folder for the figures [RESULTS]");
  verb->add_flag("--list", asked.list, "what can be drawn from what is there; draws nothing");
  verb->add_option("--width", asked.width_mm, "[mm] of each figure on paper [160]")
      ->check(CLI::Range(40.0, 400.0));
  verb->add_option("--format", asked.formats, "svg, png or both [svg,png]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"svg", "png"}));
  verb->add_option("--dpi", asked.dpi, "of PNG [300]")->check(CLI::Range(50.0, 1200.0));
  verb->add_flag("--json", asked.json, "the result as JSON on the standard output");
  const auto drawn = [&] { return app::figure(asked, std::cout); };
  verb->callback([&, drawn] { status = guarded(talk, drawn, {.json = asked.json}); });
}

void add_other_verbs(CLI::App& cli, OtherVerbs& other, show::Talk& talk, int& status) {
  auto* convert =
      cli.add_subcommand("convert", "geometry or measured data, from one format to another");
  convert->add_option("IN", other.from, "file to read")->required();
  convert->add_option("OUT", other.to, "file to write: .stl, .vtu; .csv, .uff, .mat")->required();
  convert->add_option("--unit", other.unit,
                      "unit of IN where it states none: of lengths, of responses");
  convert->add_flag("--force", other.force, "write over OUT where there is such a file");
  convert->add_flag("--hdf5", other.hdf5, "write .mat as version 7.3, which is HDF5");
  convert->callback([&] {
    status = guarded(talk, [&] {
      show::require_new_output(other.from, other.to, other.force);
      return app::convert(other.from, other.to, other.unit, other.hdf5, std::cout);
    });
  });
  auto* fresh = cli.add_subcommand("new", "a first study, by asking or from a body's file");
  fresh
      ->add_option("WHAT", other.fresh.what,
                   "beam, plate, disc or wafer_table, or the study to write")
      ->required();
  fresh->add_option("--from", other.fresh.from, "the body's file: .step, .stl, .inp, ...");
  fresh->add_option("--unit", other.fresh.unit, "of its lengths, where it states none: mm");
  fresh->add_option("-o,--output", other.fresh.output, "the study to write [WHAT.toml]");
  fresh->callback(
      [&] { status = guarded(talk, [&] { return app::new_study(other.fresh, std::cout); }); });
  add_figure_verb(cli, other.figures, talk, status);
  auto* list = cli.add_subcommand("list", "what there is to choose from, with sources");
  list->add_option("WHAT", other.what, "what")->required()->check(CLI::IsMember(app::listable()));
  list->callback([&] { status = guarded(talk, [&] { return app::list(other.what, std::cout); }); });
  auto* cache = cli.add_subcommand("cache", "meshes and modes of earlier runs: where, how large");
  cache->add_flag("--clear", other.clear, "remove them all");
  cache->add_flag("--json", other.json, "the result as JSON on the standard output");
  const auto kept = [&] { return app::cache(other.clear, other.json, std::cout); };
  cache->callback([&, kept] { status = guarded(talk, kept, {.json = other.json}); });
  auto* doctor = cli.add_subcommand("doctor", "checks the installation");
  doctor->callback([&] { status = guarded(talk, [] { return app::doctor(std::cout); }); });
}

void add_sweep_verbs(CLI::App& cli, app::SweepCommand& sweep, show::Talk& talk, int& status) {
  auto* run = cli.add_subcommand("sweep", "many studies: a base and axes along which they differ");
  auto* gather = cli.add_subcommand("gather", "the results of a sweep in one table");
  for (auto* verb : {run, gather}) {
    verb->add_option("PLAN", sweep.plan, "the plan, a .toml file")->required();
    verb->add_option("-o,--output", sweep.folder, "folder of the sweep [out/<plan name>]");
    verb->add_option("--allow-outside", sweep.allowed,
                     "absolute folder from which the variants may read files")
        ->check(CLI::ExistingDirectory);
    verb->add_flag("--json", sweep.json, "the result as JSON on the standard output");
    verb->add_flag("!--no-pictures", sweep.pictures, "paint nothing");
  }
  run->add_flag("!--no-cache", sweep.cache, "each variant meshes and solves anew");
  run->add_flag("--reproducible", sweep.reproducible, "no wall times in the results");
  run->add_flag("--list", sweep.list, "the variants and whether they are done; runs none");
  run->add_option("--run", sweep.run, "one variant, 3, or every tenth from the third on, 3/10");
  run->add_flag("--scripts", sweep.scripts, "a SLURM job array and a Makefile; runs none");
  run->add_flag("--retry", sweep.retry, "also what failed");
  run->add_option("--jobs", sweep.jobs, "variants at a time [cores / threads]")
      ->check(CLI::Range(1, 1024));
  run->add_option("--threads", sweep.threads, "threads of each variant [1]")
      ->check(CLI::Range(1, 1024));
  const auto all = [&] {
    sweep.program = std::filesystem::read_symlink("/proc/self/exe");
    const int code = app::sweep(sweep, std::cout, std::cerr, talk.progress());
    talk.clear_progress();
    return code;
  };
  const auto joined = [&] { return app::gather(sweep, std::cout, std::cerr); };
  run->callback([&, all] { status = guarded(talk, all, {.json = sweep.json}); });
  gather->callback([&, joined] { status = guarded(talk, joined, {.json = sweep.json}); });
}

std::string asked_instead(const std::string& nearest) {
  return nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?";
}

/// What is wrong with a word of the command line that is no verb, or no option of its verb; empty
/// where each is one.
std::string slip(const CLI::App& cli, const std::vector<std::string>& words) {
  std::vector<std::string> verbs, options;
  const CLI::App* chosen = nullptr;
  const auto word = std::ranges::find_if(words, [](const auto& w) { return !w.starts_with("-"); });
  if (word == words.end()) return "";
  for (const auto* verb : cli.get_subcommands([](const CLI::App* /*any*/) { return true; })) {
    verbs.push_back(verb->get_name());
    if (verbs.back() == *word) chosen = verb;
  }
  if (chosen == nullptr) {
    const auto nearest = study::nearest_name(*word, verbs);
    return "there is no verb \"" + *word + "\"" +
           (nearest.empty() ? "; expected " + study::listed(verbs) : asked_instead(nearest));
  }
  for (const auto* option : chosen->get_options()) {
    for (const auto& name : option->get_lnames()) options.push_back("--" + name);
  }
  for (const auto& one : words) {
    const auto name = one.substr(0, one.find('='));
    if (!name.starts_with("--") || std::ranges::count(options, name) > 0) continue;
    return chosen->get_name() + " has no option \"" + name + "\"" +
           asked_instead(study::nearest_name(name, options));
  }
  return "";
}

/// Reads the command line `argv` and runs its verb.
int answer(int argc, char** argv, show::Talk& talk) {
  CLI::App cli{"Modes of flexible stages, and where to sense and push on them."};
  cli.name("chladni");
  cli.require_subcommand(1);
  cli.set_version_flag("--version", "chladni " + show::version());
  std::filesystem::path file;
  show::Options options;
  OtherVerbs other;
  app::SweepCommand sweep;
  int status = kDone;
  for (const auto* command : kCommands) {
    auto* verb = cli.add_subcommand(std::string(command->name), std::string(command->summary));
    add_options(*verb, *command, file, options);
    verb->callback([&, command] { status = run_or_watch(*command, file, options); });
  }
  add_sweep_verbs(cli, sweep, talk, status);
  add_other_verbs(cli, other, talk, status);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const auto wrong = slip(cli, {argv + 1, argv + argc});
    if (e.get_exit_code() != 0 && !wrong.empty()) {
      std::cerr << wrong << "\nRun with --help for more information.\n";
      return kUsage;
    }
    return cli.exit(e, std::cout, std::cerr) == 0 ? kDone : kUsage;
  }
  return status;
}

// A parent may leave a standard stream closed; the next file would get its number, and what is
// printed. So something stands there whose use fails: reads of the input, writes to the others.
// A parent may also ignore SIGCHLD, which hides how workers end.
void mend_what_the_parent_left() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    if (stream == STDERR_FILENO) is_mute = true;
    const int unusable = stream == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    static_cast<void>(open("/dev/null", unusable));  // gets the lowest free number
  }
  std::signal(SIGCHLD, SIG_DFL);
}

}  // namespace

int main(int argc, char** argv) {
  mend_what_the_parent_left();
  try {
    show::Talk talk(std::cerr, show::manner_of_stderr(false));
    return guarded(talk, [&] {
      chladni::dense::use_best_blas_kernel(argv);
      chladni::catch_interrupts();
      const int status = answer(argc, argv, talk);
      if (status == kDone) {
        require_output();
        chladni::throw_if_interrupted();
      }
      return status;
    });
  } catch (...) {  // no memory for the message itself
    constexpr std::string_view sentence = "error: out of memory, also for saying more\n";
    static_cast<void>(!write(STDERR_FILENO, sentence.data(), sentence.size()));
    return kOutOfResources;
  }
}
