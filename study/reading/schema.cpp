#include "study/schema.h"

#include <map>

namespace chladni::study {

std::string json_name(const std::string& name, const std::string& si_unit) {
  static const std::map<std::string, std::string> suffixes = {{"1", ""},
                                                              {"Hz", "_hz"},
                                                              {"kg", "_kg"},
                                                              {"kg m^2", "_kg_m2"},
                                                              {"m", "_m"},
                                                              {"m/N", "_m_per_n"},
                                                              {"N", "_n"},
                                                              {"N/m", "_n_per_m"},
                                                              {"N s/m", "_n_s_per_m"},
                                                              {"N m/rad", "_n_m_per_rad"},
                                                              {"N m s/rad", "_n_m_s_per_rad"},
                                                              {"rad", "_rad"},
                                                              {"s", "_s"},
                                                              {"V", "_v"},
                                                              {"N/V", "_n_per_v"}};
  return name + suffixes.at(si_unit);
}

std::string expected_quantity(const std::string& si_unit, Sign sign) {
  const std::string unit = si_unit == "1" ? "a number" : "a quantity in " + si_unit;
  if (sign == Sign::positive) return unit + ", positive";
  return sign == Sign::not_negative ? unit + ", not negative" : unit;
}

std::string quoted(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "\"" : ", \"") + name + "\"";
  return text;
}

std::string default_text(double value, const std::string& si_unit) {
  return si_unit == "1" || value == 0.0 ? fmt::format("{:.6g}", value)
                                        : fmt::format("\"{:.6g} {}\"", value, si_unit);
}

}  // namespace chladni::study
