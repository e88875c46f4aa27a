// From a study to what its placement is for.
#pragma once

#include "steps/placement.h"

namespace chladni::steps {

/// The study's plan, or a default one.
[[nodiscard]] study::PlacementPlan placement_plan(const study::Study& study);

/// The study's structure at its channels and points of interest.
/// @throws InvalidInput  a point of interest is not on the body
[[nodiscard]] placement::Structure structure_of(const study::Study& study,
                                                const stage::Solution& solution,
                                                const study::PlacementPlan& plan, unsigned seed);

/// The plan as the room `placement` takes it.
[[nodiscard]] placement::Plan room_plan(const study::PlacementPlan& plan,
                                        const placement::Structure& structure);

/// @throws InvalidInput  a rule names a patch that does not exist
[[nodiscard]] std::vector<placement::Rule> rules_of(const mesh::TetMesh& body,
                                                    const study::PlacementPlan& plan,
                                                    const placement::Structure& structure,
                                                    const stage::Faces& faces);

/// Zones seen from above, and patches. @param key  of the study, for messages
/// @throws InvalidInput  a patch that does not exist
[[nodiscard]] std::vector<placement::Rule> zones_of(const mesh::TetMesh& body,
                                                    const std::vector<study::KeepOut>& zones,
                                                    const std::string& key);

/// What the layout of [placement.observer] is to know: the disturbances, noise and sample rate of
/// [observer] on the simulated modes, over the region. `notes` gets a sentence for each limit.
/// @param surface  where devices may be
/// @throws InvalidInput  no [observer], noise, sample rate or damping; a place off the body; a
/// region
///                       without a point; sensors that do not measure displacements; the floor
///                       beside attachments that move by themselves
[[nodiscard]] placement::ObserverTask observer_task(const study::Study& study,
                                                    const stage::Solution& solution,
                                                    const study::PlacementPlan& plan,
                                                    const placement::Structure& structure,
                                                    const placement::Sites& surface,
                                                    std::vector<std::string>& notes);

/// The scores of the study's layouts, then of the best layouts. `places` has the latter; its notes
/// get a sentence for channels of one kind in one place.
void add_layouts(const study::Study& study, const stage::Solution& solution,
                 const placement::Structure& structure, const placement::Plan& plan,
                 BestPlaces& places);

}  // namespace chladni::steps
