# packages: commonroad-io==2026.1 lanelet2==1.2.3
"""Writes the same street with the formats' own libraries, for `sceneloom import`: FOLDER/commonroad/own.xml and FOLDER/lanelet2/own.osm.

Two lanes along x from 0 to 100 m, the left border at y = 7, the lane line at 3.5, the right border at 0; CommonRoad also a stop line at
x = 80, a walkway from y = 0 to -2 and a parked vehicle. The Lanelet2 map is around 50 degrees north, 9 east.
"""
import json
import os
import sys
import warnings
from importlib.metadata import version

import numpy as np

warnings.filterwarnings("ignore")


def commonroad(path):
    from commonroad.common.common_lanelet import LaneletType, LineMarking, StopLine
    from commonroad.common.file_writer import CommonRoadFileWriter, OverwriteExistingFile
    from commonroad.common.util import FileFormat, Interval
    from commonroad.geometry.obstacle_shapes.rect_obstacle_shape import RectObstacleShape
    from commonroad.planning.goal import GoalRegion
    from commonroad.planning.planning_problem import PlanningProblem, PlanningProblemSet
    from commonroad.scenario.lanelet import Lanelet
    from commonroad.scenario.obstacle import ObstacleType, StaticObstacle
    from commonroad.scenario.scenario import Scenario, ScenarioID
    from commonroad.scenario.state import CustomState, InitialState

    x = np.linspace(0, 100, 21)

    def lanelet(number, left, right, **more):
        bounds = [np.stack([x, 0 * x + y], 1) for y in (left, right)]
        return Lanelet(bounds[0], (bounds[0] + bounds[1]) / 2, bounds[1], number, **more)

    def state(at, speed):
        still = dict(orientation=0.0, time_step=0, acceleration=0.0, yaw_rate=0.0, slip_angle=0.0)
        return InitialState(position=np.array(at), velocity=speed, **still)

    scenario = Scenario(0.1, ScenarioID.from_benchmark_id("ZAM_Own-1_1_T-1", "2020a"))
    stop = StopLine(np.array([80.0, 3.5]), np.array([80.0, 0.0]), LineMarking.SOLID)
    scenario.add_objects(
        [
            lanelet(
                1,
                3.5,
                0.0,
                lanelet_type={LaneletType.URBAN},
                line_marking_left_vertices=LineMarking.DASHED,
                adjacent_left=2,
                adjacent_left_same_direction=True,
                stop_line=stop,
            ),
            lanelet(
                2,
                7.0,
                3.5,
                lanelet_type={LaneletType.URBAN},
                line_marking_right_vertices=LineMarking.DASHED,
                adjacent_right=1,
                adjacent_right_same_direction=True,
            ),
            lanelet(3, 0.0, -2.0, lanelet_type={LaneletType.SIDEWALK}),
        ]
    )
    parked = StaticObstacle(50, ObstacleType.PARKED_VEHICLE, RectObstacleShape(1.9, 4.5), state([30.0, 1.75], 0.0))
    scenario.add_objects(parked)
    goal = GoalRegion([CustomState(time_step=Interval(0, 50))])
    problems = PlanningProblemSet([PlanningProblem(60, state([50.0, 1.75], 5.0), goal)])
    about = dict(author="a", affiliation="b", source="c", tags=set(), file_format=FileFormat.XML)
    writer = CommonRoadFileWriter(scenario, problems, **about)
    writer.write_to_file(path, OverwriteExistingFile.ALWAYS)


def lanelet2(path):
    from lanelet2.core import Lanelet, LaneletMap, LineString3d, Point3d, getId
    from lanelet2.io import Origin, write
    from lanelet2.projection import UtmProjector

    def line(y, kind, subtype):
        out = LineString3d(getId(), [Point3d(getId(), x, y, 0.0) for x in range(0, 101, 10)])
        out.attributes["type"], out.attributes["subtype"] = kind, subtype
        return out

    lines = [line(7.0, "road_border", ""), line(3.5, "line_thin", "dashed"), line(0.0, "curbstone", "high")]
    road_map = LaneletMap()
    for left, right in zip(lines, lines[1:]):
        lanelet = Lanelet(getId(), left, right)
        for key, value in (("subtype", "road"), ("location", "urban"), ("one_way", "yes")):
            lanelet.attributes[key] = value
        road_map.add(lanelet)
    write(path, road_map, UtmProjector(Origin(50.0, 9.0)))


def main(folder):
    for name in ("commonroad", "lanelet2"):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
    commonroad(os.path.join(folder, "commonroad", "own.xml"))
    lanelet2(os.path.join(folder, "lanelet2", "own.osm"))
    versions = {name: version(name) for name in ("commonroad-io", "lanelet2")}
    print(json.dumps({"writer": " + ".join(versions), "version": " + ".join(versions.values()), "written": 2}))


if __name__ == "__main__":
    main(sys.argv[1])
