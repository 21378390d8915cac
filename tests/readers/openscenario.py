# packages: asam-qc-openscenarioxml==1.0.0 asam-qc-opendrive==1.0.0 scenariogeneration==0.16.7 xmlschema lxml
"""Checks an exported folder (scenario.xosc, map.xodr) with the ASAM quality checker and its schema of OpenSCENARIO XML 1.3, and reads
entities and trajectories back with scenariogeneration."""
import json
import logging
import os
import sys
from importlib.metadata import version

logging.disable(logging.CRITICAL)
from lxml import etree  # noqa: E402
from qc_baselib import Configuration, IssueSeverity, Result  # noqa: E402
from qc_openscenario import constants  # noqa: E402
from qc_openscenario import main as checker  # noqa: E402
from scenariogeneration import xosc  # noqa: E402


def checked(path):
    """Errors and warnings of the ASAM checker, by rule; and how many rules were looked at."""
    config = Configuration()
    config.set_config_param("InputFile", path)
    config.register_checker_bundle(constants.BUNDLE_NAME)
    result = Result()
    result.register_checker_bundle(
        name=constants.BUNDLE_NAME, description="", version=constants.BUNDLE_VERSION, summary=""
    )
    result.set_result_version(version=constants.BUNDLE_VERSION)
    checker.run_checks(config, result)
    errors, warnings, rules = {}, {}, 0
    for rule in result.get_checker_results(constants.BUNDLE_NAME):
        status = str(rule.status).lower()
        rules += "completed" in status
        if "error" in status:
            errors[rule.checker_id] = rule.summary
        for issue in rule.issues:
            kind = errors if issue.level == IssueSeverity.ERROR else warnings
            kind[rule.checker_id] = issue.description
    return errors, warnings, rules


def main(folder):
    path = os.path.join(folder, "scenario.xosc") if os.path.isdir(folder) else folder
    folder = os.path.dirname(path)
    errors, warnings, rules = checked(path)
    if errors or rules < 8:
        sys.exit(f"ASAM checker: {rules} rules, errors {errors}")
    root = etree.parse(path).getroot()
    logic = root.find("RoadNetwork/LogicFile").get("filepath")
    if not os.path.isfile(os.path.join(folder, logic)):
        sys.exit(f"{logic}: not beside the scenario")
    sizes = {}
    for node in root.findall("Entities/ScenarioObject"):
        kind = {"Vehicle": xosc.Vehicle, "Pedestrian": xosc.Pedestrian, "MiscObject": xosc.MiscObject}
        inner = next(c for c in node if c.tag in kind)
        box = kind[inner.tag].parse(inner).boundingbox.boundingbox
        sizes[node.get("name")] = (box.length, box.width, box.height)
    if "Ego" not in sizes or min(min(s) for s in sizes.values()) <= 0:
        sys.exit(f"entities {list(sizes)[:5]}")
    vertices = paths = 0
    for node in root.iter("PrivateAction"):
        if node.find("RoutingAction/FollowTrajectoryAction") is None:
            continue
        action = xosc.FollowTrajectoryAction.parse(node)
        times = action.trajectory.shapes.time
        if times != sorted(times) or len(set(times)) != len(times):
            sys.exit(f"{action.trajectory.name}: times do not grow")
        paths += 1
        vertices += len(times)
    teleports = len(root.findall(".//Init//TeleportAction"))
    environment = xosc.EnvironmentAction.parse(root.find(".//Init//GlobalAction"))
    stop = float(root.find("Storyboard/StopTrigger//SimulationTimeCondition").get("value"))
    versions = {name: version(name) for name in ("asam-qc-openscenarioxml", "scenariogeneration")}
    read = {
        "rules": rules,
        "errors": 0,
        "warnings": len(warnings),
        "entities": len(sizes),
        "teleports": teleports,
        "trajectories": paths,
        "vertices": vertices,
        "environment": environment.environment.name,
        "stop_s": stop,
    }
    name = " + ".join(versions)
    print(json.dumps({"reader": name, "version": " + ".join(versions.values()), "accepted": True, "read": read}))


if __name__ == "__main__":
    main(sys.argv[1])
