# packages: laspy[lazrs]==2.7.0 numpy
"""Reads lidar.laz as las.py reads lidar.las."""
import pathlib
import runpy

runpy.run_path(str(pathlib.Path(__file__).with_name("las.py")), run_name="__main__")
