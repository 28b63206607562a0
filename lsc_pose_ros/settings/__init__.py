"""The settings of estimation: each is declared once, in `table.py`.

ROS parameters, command-line options, `pose_node.yaml` and `docs/parameters.md` are made from it.
"""
