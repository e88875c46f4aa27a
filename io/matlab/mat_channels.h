// The channels of one side in a .mat file: "output", "input" or "reference".
#pragma once

#include <string>
#include <vector>

#include "io/mat.h"
#include "modal/frf_set.h"

namespace chladni::io {

/// Adds names, and what any channel states of units, nodes, directions and places.
void add_channels(MatFields& fields, const std::string& side,
                  const std::vector<modal::MeasuredChannel>& channels);

/// Reads into channels what `add_channels` wrote, but for the names. OutputUnit and InputUnit of
/// MATLAB's frd objects are units too.
/// @throws InvalidInput  numbers or texts that are not those of so many channels
void describe_channels(const MatFields& fields, const std::string& side,
                       std::vector<modal::MeasuredChannel>& channels);

/// Gives outputs without a unit that of `unit` or `units`: one text, or one per output. A variable
/// of that name without texts is another program's.
/// @return  whether there is such a variable, and it was read
/// @throws InvalidInput  texts that are not those of so many outputs, a unit of frequency or time
bool state_one_unit(const MatFields& fields, std::vector<modal::MeasuredChannel>& outputs);

/// Adds the motion that each output measures as `kind`, where the unit of one of them does not tell
/// it; "" where it is not known.
void add_kinds(MatFields& fields, const std::vector<modal::MeasuredChannel>& outputs);

/// Sets what `kind` states of outputs: one word for all, or one per output. Words are those of
/// responses (receptance, mobility, accelerance) or of motions (displacement, velocity,
/// acceleration); an empty one states nothing.
/// @return  for each output whether its kind is stated
/// @throws InvalidInput  another word, words that are not those of so many outputs
std::vector<bool> read_kinds(const MatFields& fields, std::vector<modal::MeasuredChannel>& outputs);

}  // namespace chladni::io
