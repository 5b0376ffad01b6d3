#include "lancet/mesh/repair.hpp"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace {

using lancet::mesh::repair;
using lancet::mesh::Repaired;
using lancet::mesh::TetMesh;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TetMesh::Definition soiled() {
    return {.nodes = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {8, 8, 8}, {0, 0, 1}, {1, 1, 1}, {0.5, 0.5, 0}},
            .tetrahedra = {{1, 2, 3, 5}, {1, 2, 3, 7}, {2, 3, 6, 5}, {3, 2, 1, 5}, {1, 1, 2, 3}},
            .regions = {10, 11, 12, 13, 14},
            .node_sets = {{"held", {0, 1, 7}}}};
}

TEST(Repair, LeavesACleanMeshAlone) {
    const auto clean = lancet::mesh::box({.cells = {2, 2, 2}}).definition();
    const Repaired repaired = repair(clean);
    EXPECT_THAT(repaired.notes, IsEmpty());
    EXPECT_EQ(repaired.definition.nodes, clean.nodes);
    EXPECT_EQ(repaired.definition.tetrahedra, clean.tetrahedra);
    EXPECT_EQ(repaired.definition.node_sets, clean.node_sets);
}

TEST(Repair, DoesEverythingItIsAllowedToAndSaysSo) {
    const Repaired repaired = repair(soiled(), {.drop_flat = true, .drop_duplicates = true});
    EXPECT_THAT(repaired.notes, ElementsAre(HasSubstr("turned 2 of 5 elements"), HasSubstr("dropped 1 flat elements"),
                                            HasSubstr("dropped 1 elements with a repeated node"),
                                            HasSubstr("dropped 1 elements that repeat"),
                                            HasSubstr("dropped 3 of 8 nodes"), HasSubstr("node set 'held' lost 2")));
    const TetMesh mesh(repaired.definition);
    EXPECT_EQ(mesh.nodes().size(), 5U);
    EXPECT_THAT(mesh.regions(), ElementsAre(10, 12));
    EXPECT_THAT(mesh.node_set("held"), ElementsAre(0));
    EXPECT_THAT(repaired.node_of_new, ElementsAre(1, 2, 3, 5, 6));
    EXPECT_THAT(repaired.new_of_node, ElementsAre(-1, 0, 1, 2, -1, 3, 4, -1));
    EXPECT_THAT(repaired.element_of_new, ElementsAre(0, 2));
    EXPECT_THAT(repaired.new_of_element, ElementsAre(0, -1, 1, -1, -1));
    EXPECT_DOUBLE_EQ(mesh.volume(), 1.0 / 6 + 1.0 / 3);
}

TEST(Repair, DropsNoElementUnlessAsked) {
    const Repaired repaired = repair(soiled());
    EXPECT_EQ(repaired.definition.tetrahedra.size(), 5U);
    EXPECT_THROW(TetMesh(repaired.definition), lancet::Error);
}

TEST(Repair, DoesNothingWhenNothingIsAllowed) {
    const Repaired repaired = repair(soiled(), {.turn_inverted = false, .drop_isolated_nodes = false});
    EXPECT_THAT(repaired.notes, IsEmpty());
    EXPECT_EQ(repaired.definition.tetrahedra, soiled().tetrahedra);
    EXPECT_EQ(repaired.definition.nodes, soiled().nodes);
}

TEST(Repair, LeavesNumbersOutOfRangeToBeReported) {
    auto definition = soiled();
    definition.tetrahedra[0][1] = 1000;
    definition.node_sets["held"].push_back(-7);
    EXPECT_THROW(TetMesh(repair(std::move(definition), {.drop_flat = true, .drop_duplicates = true}).definition),
                 lancet::Error);
}

}  // namespace
