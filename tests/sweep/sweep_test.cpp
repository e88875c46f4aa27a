// Runs of a sweep: done once, resumed, shared, and gathered.
#include "sweep/sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <string>
#include <system_error>

#include "base/error.h"
#include "base/interrupt.h"
#include "study/study.h"
#include "sweep/gathered.h"
#include "sweep/scripts.h"
#include "sweep/sweep_folder.h"
#include "sweep/variant_lock.h"

namespace chladni::sweep {
namespace {

namespace fs = std::filesystem;

SweepOptions options_of(const SweepFolder& folder, const std::string& out = "out") {
  return {.folder = folder.path() / out,
          .program = folder.path() / "program",
          .allowed = {},
          .threads = 1,
          .passing = {5, 130}};
}

TEST(Sweep, RunsEachVariantOnceAndKeepsWhatFailed) {
  const SweepFolder folder("once");
  const Sweep sweep(folder.plan(), options_of(folder));
  for (long long i = 0; i < sweep.size(); ++i) EXPECT_EQ(sweep.run(i).outcome, Outcome::ran) << i;
  EXPECT_EQ(folder.calls(), 6);
  for (long long i = 0; i < sweep.size(); ++i) EXPECT_EQ(sweep.run(i).outcome, Outcome::found) << i;
  EXPECT_EQ(folder.calls(), 6);
  const auto all = gathered(sweep);
  EXPECT_EQ(all.done, 4);
  EXPECT_EQ(all.failed, 2);
  EXPECT_EQ(all.open, 0);
  EXPECT_EQ(all.rows[0].results(0), 160.0);
  EXPECT_EQ(all.rows[2].results(0), 200.0);
  EXPECT_TRUE(std::isnan(all.rows[5].results(0)));
  EXPECT_EQ(all.rows[5].entry.record->exit, 3);
  EXPECT_EQ(all.rows[5].entry.record->error, "error: it is too thick");
  EXPECT_TRUE(all.rows[2].on_front);
  EXPECT_FALSE(all.rows[0].on_front);
}

TEST(Sweep, WhatFailedRunsAgainOnRequest) {
  const SweepFolder folder("again");
  const Sweep sweep(folder.plan(), options_of(folder));
  EXPECT_EQ(sweep.run(5).outcome, Outcome::ran);
  EXPECT_EQ(sweep.run(5, true).outcome, Outcome::ran);
  EXPECT_EQ(folder.calls(), 2);
}

// A process that dies leaves no result, and the next sweep tries again.
TEST(Sweep, AVariantThatIsKilledIsTriedAgain) {
  auto text = kPlan;
  text.replace(text.find("16 mm"), 5, "99 mm");
  const SweepFolder folder("killed", text);
  const Sweep sweep(folder.plan(), options_of(folder));
  const auto met = sweep.run(0);
  EXPECT_EQ(met.outcome, Outcome::passing);
  EXPECT_NE(met.why.find("signal 9"), std::string::npos) << met.why;
  EXPECT_FALSE(sweep.entry(0).record);
  EXPECT_FALSE(fs::exists(sweep.entry(0).folder));
  write(folder.path() / "mended", "");
  EXPECT_EQ(sweep.run(0).outcome, Outcome::ran);
  EXPECT_EQ(sweep.entry(0).record->exit, 0);
}

TEST(Sweep, ARunThatWasCutOffIsDoneAfresh) {
  const SweepFolder folder("cut");
  const Sweep sweep(folder.plan(), options_of(folder));
  auto part = sweep.entry(1).folder;
  part += ".part";
  fs::create_directories(part);
  write(part / "modes.json", "{ half of");
  write(part / "left_over.json", "{}");
  EXPECT_EQ(sweep.run(1).outcome, Outcome::ran);
  EXPECT_FALSE(fs::exists(part));
  EXPECT_FALSE(fs::exists(sweep.entry(1).folder / "left_over.json"));
  EXPECT_EQ(gathered(sweep).rows[1].results(0), 160.0);
}

TEST(Sweep, AVariantThatAnotherProcessRunsIsLeftToIt) {
  const SweepFolder folder("shared");
  const Sweep sweep(folder.plan(), options_of(folder));
  const auto locks = folder.path() / "out" / "variants" / ".locks";
  fs::create_directories(locks);
  {
    const VariantLock other(locks / sweep.entry(2).hash);
    ASSERT_FALSE(other.is_elsewhere());
    EXPECT_TRUE(VariantLock(locks / sweep.entry(2).hash).is_elsewhere());
    EXPECT_EQ(sweep.run(2).outcome, Outcome::elsewhere);
    EXPECT_EQ(folder.calls(), 0);
  }
  EXPECT_EQ(sweep.run(2).outcome, Outcome::ran);
}

// The hash is that of what the results depend on: not of the title, the order of the axes or the
// folder, but of the base, the values and the verb.
TEST(Sweep, TheHashFollowsTheContent) {
  const SweepFolder folder("hash");
  const auto plan = folder.plan();
  const Sweep sweep(plan, options_of(folder));
  const auto hash = sweep.entry(0).hash;
  EXPECT_NE(hash, sweep.entry(1).hash);
  EXPECT_EQ(Sweep(plan, options_of(folder, "deep/er/out")).entry(0).hash, hash);
  auto titled = plan;
  titled.title = "others";
  EXPECT_EQ(Sweep(titled, options_of(folder)).entry(0).hash, hash);
  auto placed = plan;
  placed.verb = "place";
  EXPECT_NE(Sweep(placed, options_of(folder)).entry(0).hash, hash);
  auto changed = kBase;
  changed.replace(changed.find("400 mm"), 6, "401 mm");
  write(folder.path() / "base.toml", changed);
  EXPECT_NE(sweep.entry(0).hash, hash);
}

TEST(Sweep, AVariantThatIsNoStudyIsToldBeforeAnythingRuns) {
  auto text = kPlan;
  text.replace(text.find("20 mm"), 5, "20 kg");
  const SweepFolder folder("no_study", text);
  const Sweep sweep(folder.plan(), options_of(folder));
  try {
    sweep.check();
    ADD_FAILURE() << "taken";
  } catch (const InvalidInput& e) {
    const std::string said = e.what();
    EXPECT_NE(said.find("variant 3 (20 kg, 60 GPa)"), std::string::npos) << said;
    EXPECT_NE(said.find("thickness"), std::string::npos) << said;
  }
  EXPECT_EQ(folder.calls(), 0);
}

// The system follows ".." from where a link leads.
TEST(Sweep, ItsFolderMayLieBehindALink) {
  const SweepFolder folder("link");
  fs::create_directories(folder.path() / "far/away/scratch");
  fs::create_directory_symlink(folder.path() / "far/away/scratch", folder.path() / "out");
  const Sweep sweep(folder.plan(), options_of(folder));
  ASSERT_EQ(sweep.run(0).outcome, Outcome::ran);
  const auto file = sweep.entry(0).folder / "study.toml";
  const auto study = study::read_study(file, {folder.path()});
  EXPECT_TRUE(fs::equivalent(study.bases.at(0), folder.path() / "base.toml"));
}

TEST(Sweep, StartsNothingAfterCtrlC) {
  const SweepFolder folder("stopped");
  const Sweep sweep(folder.plan(), options_of(folder));
  {
    const NotedInterrupts noted;
    std::raise(SIGINT);
    EXPECT_THROW(static_cast<void>(sweep.run(0)), Interrupted);
    forget_interrupt();
  }
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
  EXPECT_EQ(folder.calls(), 0);
}

TEST(Sweep, AFolderThatCannotBeMadeIsTold) {
  const SweepFolder folder("no_folder");
  write(folder.path() / "out", "a file");
  const Sweep sweep(folder.plan(), options_of(folder));
  EXPECT_THROW(static_cast<void>(sweep.run(0)), InvalidInput);
}

TEST(Sweep, LeavesATableAndJson) {
  const SweepFolder folder("files");
  const Sweep sweep(folder.plan(), options_of(folder));
  for (long long i = 0; i < 5; ++i) static_cast<void>(sweep.run(i));
  const auto all = gathered(sweep);
  leave(sweep, all, folder.path() / "out", false);
  const auto table = content(folder.path() / "out" / "table.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 7);
  EXPECT_EQ(table.substr(0, table.find('\n')),
            "variant,state,thickness,modulus,first [Hz],mass,on_front,folder");
  EXPECT_NE(table.find("\n1,done,16 mm,60 GPa,160,4.5,0,variants/"), std::string::npos) << table;
  EXPECT_NE(table.find("\n6,open,24 mm,80 GPa,,,0,"), std::string::npos) << table;
  const auto json = io::parse_json(content(folder.path() / "out" / "sweep.json"));
  EXPECT_EQ(json.at("done").number(), 4.0);
  EXPECT_EQ(json.at("variants").array().size(), 6U);
  const auto said = text(sweep, all);
  EXPECT_NE(said.find("most first: 200 Hz in variant 3"), std::string::npos) << said;
  EXPECT_NE(said.find("4 done, 1 failed, 1 open"), std::string::npos) << said;
}

TEST(Sweep, TellsOfAResultThatNoVariantHas) {
  auto plan = kPlan;
  plan.replace(plan.find("mass_kg"), 7, "mass_lb");
  const SweepFolder folder("nowhere", plan);
  const Sweep sweep(folder.plan(), options_of(folder));
  EXPECT_EQ(text(sweep, gathered(sweep)).find("warning"), std::string::npos);  // none has run
  static_cast<void>(sweep.run(0));
  const auto said = text(sweep, gathered(sweep));
  EXPECT_NE(said.find("modes.json has no number at \"mass_lb\""), std::string::npos) << said;
}

ScriptPlan script_plan(const SweepFolder& folder, long long variants) {
  return {.name = "a plan's",
          .program = folder.path() / "chla'dni $x",
          .plan = folder.path() / "plan.toml",
          .folder = folder.path() / "out",
          .allowed = {},
          .variants = variants,
          .threads = 1};
}

// The scripts run in a shell: a program beside them notes its arguments.
TEST(SweepScripts, CallTheProgramForEachVariant) {
  const SweepFolder folder("scripts");
  const auto plan = script_plan(folder, 3);
  write(plan.program, "#!/bin/sh\necho \"$6 $1\" >> \"$(dirname \"$0\")/noted\"\n");
  fs::permissions(plan.program, fs::perms::owner_all);
  write(folder.path() / "sweep.sbatch", slurm_script(plan));
  const auto sbatch = "SLURM_ARRAY_TASK_ID=2 bash " + (folder.path() / "sweep.sbatch").string();
  ASSERT_EQ(std::system(sbatch.c_str()), 0);
  EXPECT_EQ(content(folder.path() / "noted"), "2/3 sweep\n");
  if (std::system("make --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "there is no make";
  fs::remove(folder.path() / "noted");
  write(folder.path() / "sweep.mk", makefile(plan));
  ASSERT_EQ(std::system(("make -s -f " + (folder.path() / "sweep.mk").string()).c_str()), 0);
  EXPECT_EQ(content(folder.path() / "noted"), "1/3 sweep\n2/3 sweep\n3/3 sweep\n");
}

TEST(SweepScripts, CarryTheOptionsOfTheirCall) {
  const SweepFolder folder("flags");
  auto plan = script_plan(folder, 3);
  plan.flags = {"--retry", "--no-cache"};
  for (const auto& script : {slurm_script(plan), makefile(plan)}) {
    EXPECT_NE(script.find(" --threads 1 --retry --no-cache"), std::string::npos) << script;
  }
}

TEST(SweepScripts, ManyVariantsTakeTurnsInAThousandTasks) {
  const SweepFolder folder("many");
  const auto script = slurm_script(script_plan(folder, 25'000));
  EXPECT_NE(script.find("--array=1-1000\n"), std::string::npos) << script;
  EXPECT_NE(script.find("--job-name=a_plan_s\n"), std::string::npos) << script;
}

}  // namespace
}  // namespace chladni::sweep
