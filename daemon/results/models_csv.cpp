#include "daemon/results/models_csv.hpp"

#include "daemon/results/models.hpp"
#include "daemon/settings/toml_table.hpp"

namespace sweepd {
namespace {

using identify::Knowledge;
using identify::Quantity;

constexpr std::string_view unit(Quantity quantity) {
  switch (quantity) {
    case Quantity::length:
      return "mm";
    case Quantity::angle:
      return "deg";
    case Quantity::ratio:
      return "1";
  }
  return "";
}

}  // namespace

std::string models_csv(const std::vector<identify::KinematicModel>& models) {
  std::string csv = "model,joint,parameter,value,unit,sigma,low_95,high_95,knowledge\n";
  for (const auto& model : models)
    for (std::size_t joint = 0; joint < model.groups.size(); ++joint)
      for (const auto& [name, quantity, number] : model.groups[joint]) {
        const auto in_text = [&, of = quantity](double value) {
          return number_text(in_file_units(value, of));
        };
        csv += std::string(text(model.form)) + ',' + std::to_string(joint) + ',' +
               std::string(name) + ',' + in_text(number.value) + ',' + std::string(unit(quantity)) +
               ',';
        if (number.sigma > 0) {
          const double half = identify::kSigmasOf95Percent * number.sigma;
          csv += in_text(number.sigma) + ',' + in_text(number.value - half) + ',' +
                 in_text(number.value + half);
        } else {
          csv += ",,";
        }
        csv += number.knowledge == Knowledge::identified ? ",identified\n" : ",by_convention\n";
      }
  return csv;
}

}  // namespace sweepd
