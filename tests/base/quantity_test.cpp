#include "base/quantity.h"

#include <gtest/gtest.h>

#include <array>
#include <clocale>
#include <locale>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"

namespace chladni {
namespace {

std::string message(const char* text, const char* unit) {
  try {
    (void)quantity(text, unit);
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "";
}

TEST(Quantity, IsInSiUnits) {
  EXPECT_DOUBLE_EQ(quantity("20 mm", "m"), 0.02);
  EXPECT_DOUBLE_EQ(quantity("70 GPa", "Pa"), 70e9);
  EXPECT_DOUBLE_EQ(quantity("2700 kg/m^3", "kg/m^3"), 2700.0);
  EXPECT_DOUBLE_EQ(quantity("2.7 g/cm^3", "kg/m^3"), 2700.0);
  EXPECT_DOUBLE_EQ(quantity("1.2 N/mm", "N/m"), 1200.0);
  EXPECT_DOUBLE_EQ(quantity("180 deg", "rad"), 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(quantity("1 %", "1"), 0.01);
  EXPECT_DOUBLE_EQ(quantity("0.5", "1"), 0.5);
  EXPECT_DOUBLE_EQ(quantity("1.5 kHz", "Hz"), 1500.0);
}

TEST(Quantity, AllowsSignsExponentsAndNoBlank) {
  EXPECT_DOUBLE_EQ(quantity("-250mm", "m"), -0.25);
  EXPECT_DOUBLE_EQ(quantity(" +1.5e3 um ", "m"), 1.5e-3);
}

TEST(Quantity, ConvertsThereAndBack) {
  const char* units[] = {"mm", "um", "inch", "km", "m"};
  for (const char* a : units) {
    for (const char* b : units) {
      EXPECT_NEAR(unit_factor(a, b) * unit_factor(b, a), 1.0, 1e-14) << a << " " << b;
    }
  }
  EXPECT_DOUBLE_EQ(unit_factor("mm", "m"), 1e-3);
}

TEST(Quantity, SaysWhatWasExpected) {
  EXPECT_NE(message("20 kg", "m").find("expected a length such as \"20 mm\""), std::string::npos);
  EXPECT_NE(message("20", "m").find("has no unit"), std::string::npos);
  EXPECT_NE(message("20 furlongz", "m").find("unknown unit \"furlongz\""), std::string::npos);
  EXPECT_NE(message("mm", "m").find("does not start with a number"), std::string::npos);
  EXPECT_NE(message("nan m", "m").find("not finite"), std::string::npos);
  EXPECT_NE(message("inf m", "m").find("not finite"), std::string::npos);
  EXPECT_NE(message("1,5 mm", "m").find("decimal comma"), std::string::npos);
  EXPECT_NE(message("", "Pa").find("expected a pressure or modulus"), std::string::npos);
}

TEST(Quantity, RefusesUnitsThatAreNoFactor) {
  EXPECT_NE(message("20 degC", "K").find("offset"), std::string::npos);
  EXPECT_NE(message("20 lg(re mW)", "W").find("scale of its own"), std::string::npos);
  // UDUNITS-2 would take the reciprocal.
  EXPECT_NE(message("2 ms", "Hz").find("is a time"), std::string::npos);
  EXPECT_THROW((void)quantity("2 mm/N", "N/m"), InvalidInput);
  EXPECT_THROW((void)unit_factor("m/N", "N/m"), InvalidInput);
}

TEST(Quantity, KnowsTheUnitsOfTheTrade) {
  const struct {
    const char* text;
    const char* unit;
    double value;
  } known[] = {{"3 N m", "N m", 3.0},
               {"3 N.m", "N m", 3.0},
               {"3 N*m", "N m/rad", 3.0},
               {"2 N m/deg", "N m/rad", 2 * 180 / 3.14159265358979},
               {"5 µm", "m", 5e-6},
               {"5 N/µm", "N/m", 5e6},
               {"7.85 t/m^3", "kg/m^3", 7850},
               {"9.81 m/s²", "m/s^2", 9.81},
               {"200 GPa", "N/m^2", 2e11},
               {"45°", "rad", 0.785398163397448},
               {"60 rpm", "rad/s", 6.28318530717959},
               {"10 1/s", "Hz", 10.0},
               {"0.1 kg m^2", "kg m^2", 0.1},
               {"2e-3 kg m2", "kg m^2", 2e-3}};
  for (const auto& [text, unit, value] : known) {
    EXPECT_NEAR(quantity(text, unit), value, 1e-12 * value) << text;
  }
}

// UDUNITS-2 takes a radian for 1; then 10 rad/s would be 10 Hz, wrong by 2π and unseen.
TEST(Quantity, TellsAnglesFromPlainNumbers) {
  EXPECT_NE(message("10 rad/s", "Hz").find("is an angular velocity"), std::string::npos);
  EXPECT_THROW((void)quantity("600 rpm", "Hz"), InvalidInput);
  EXPECT_THROW((void)quantity("10 Hz", "rad/s"), InvalidInput);
  EXPECT_THROW((void)quantity("3 deg", "1"), InvalidInput);
  EXPECT_THROW((void)quantity("3 %", "rad"), InvalidInput);
}

TEST(Quantity, NamesWhatItWasGiven) {
  EXPECT_NE(message("20 kg", "m").find("\"20 kg\" is a mass"), std::string::npos);
  EXPECT_NE(message("20 kg", "Hz").find("a frequency such as \"150 Hz\""), std::string::npos);
  EXPECT_NE(message("20 kg", "mol").find("converts to mol"), std::string::npos);
  EXPECT_NE(message("20 mol", "m").find("another dimension"), std::string::npos);
}

TEST(Quantity, RefusesASecondNumberInTheUnit) {
  for (const char* text : {"600 3 mm", "1 000 mm", "600 mm 5", "2 mm*3", "5 mm/2", "1.5.3 mm"}) {
    EXPECT_NE(message(text, "m"), "") << text;
  }
}

TEST(Quantity, RefusesWhatIsNoQuantityAtAll) {
  const std::string zero_inside("5 m\0m", 5);
  const std::array<std::string, 12> wrong = {
      "",        " ",        "m",      "five mm",   "--5 mm",  "+-5 mm",
      "1e999 m", "1e308 km", "0x10 m", zero_inside, "5 m))((", "5 " + std::string(5000, 'm')};
  for (const auto& text : wrong) EXPECT_THROW((void)quantity(text, "m"), InvalidInput) << text;
  EXPECT_THROW((void)unit_factor("", "m"), InvalidInput);
  EXPECT_THROW((void)unit_factor("3 mm", "m"), InvalidInput);
  EXPECT_THROW((void)unit_factor("mm", "flurb"), InvalidInput);
}

TEST(Quantity, IsQuietOnErrors) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  EXPECT_THROW((void)quantity("5 furlongz))", "m"), InvalidInput);
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
}

TEST(Quantity, MayBeReadFromSeveralThreads) {
  std::vector<std::thread> threads;
  std::vector<double> sums(4, 0.0);
  for (auto& sum : sums) {
    threads.emplace_back([&sum] {
      for (int i = 0; i < 500; ++i) sum += quantity("1 mm", "m");
    });
  }
  for (auto& thread : threads) thread.join();
  for (const double sum : sums) EXPECT_NEAR(sum, 0.5, 1e-12);
}

struct DecimalComma : std::numpunct<char> {
  [[nodiscard]] char do_decimal_point() const override { return ','; }
  [[nodiscard]] char do_thousands_sep() const override { return '.'; }
  [[nodiscard]] std::string do_grouping() const override { return "\3"; }
};

TEST(Quantity, DoesNotDependOnTheLocale) {
  const std::string kept = std::setlocale(LC_NUMERIC, nullptr);
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  EXPECT_DOUBLE_EQ(quantity("1.5 mm", "m"), 1.5e-3);
  EXPECT_DOUBLE_EQ(quantity("1500 kg/m^3", "kg/m^3"), 1500.0);
  std::locale::global(before);
  for (const char* locale : {"nl_NL.UTF-8", "de_DE.UTF-8", "C.UTF-8"}) {
    if (std::setlocale(LC_NUMERIC, locale) == nullptr) continue;  // not installed
    EXPECT_DOUBLE_EQ(quantity("1.5 mm", "m"), 1.5e-3) << locale;
  }
  std::setlocale(LC_NUMERIC, kept.c_str());
}

}  // namespace
}  // namespace chladni
