"""Starts the monitor `sinew-watch` and, on request, an aggregator of its diagnostics and the broadcaster of a controller manager.

    ros2 launch sinew_ros sinew.launch.py monitor:=/etc/sinew/watch.toml
    ros2 launch sinew_ros sinew.launch.py aggregator:=true
    ros2 launch sinew_ros sinew.launch.py broadcaster:=true parameters:=/etc/sinew/broadcaster.yaml

The program `sinew-watch` has to be in PATH (`cargo install sinew-watch`, or the Debian package).
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition, LaunchConfigurationNotEquals
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    """All parts, each with its file of parameters."""
    shipped = FindPackageShare("sinew_ros")
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "monitor",
                default_value=PathJoinSubstitution([shipped, "config", "watch.toml"]),
                description="Configuration of the monitor; empty: no monitor",
            ),
            DeclareLaunchArgument(
                "aggregator",
                default_value="false",
                description="Whether /diagnostics is grouped for rqt_robot_monitor",
            ),
            DeclareLaunchArgument(
                "broadcaster",
                default_value="false",
                description="Whether the broadcaster is loaded into the controller manager",
            ),
            DeclareLaunchArgument(
                "parameters",
                default_value=PathJoinSubstitution([shipped, "config", "broadcaster.yaml"]),
                description="Parameters of the broadcaster",
            ),
            DeclareLaunchArgument(
                "controller_manager",
                default_value="/controller_manager",
                description="Name of the controller manager",
            ),
            ExecuteProcess(
                cmd=["sinew-watch", LaunchConfiguration("monitor")],
                name="sinew_watch",
                output="screen",
                # It stores the current sessions within 20 s.
                sigterm_timeout="25",
                condition=LaunchConfigurationNotEquals("monitor", ""),
            ),
            Node(
                package="diagnostic_aggregator",
                executable="aggregator_node",
                parameters=[PathJoinSubstitution([shipped, "config", "aggregator.yaml"])],
                output="screen",
                condition=IfCondition(LaunchConfiguration("aggregator")),
            ),
            Node(
                package="controller_manager",
                executable="spawner",
                arguments=[
                    "offset_broadcaster",
                    "--controller-manager",
                    LaunchConfiguration("controller_manager"),
                    "--param-file",
                    LaunchConfiguration("parameters"),
                ],
                output="screen",
                condition=IfCondition(LaunchConfiguration("broadcaster")),
            ),
        ]
    )
