"""Scheduler of workers: files stay together, cases with parameters are spread, a case that kills its worker ends."""

from typing import Any

from xdist.scheduler import LoadScopeScheduling  # type: ignore[import-untyped]


class ByFile(LoadScopeScheduling):  # type: ignore[misc]
    """Scheduler whose unit of work is a file, or one set of parameters of a case."""

    def _split_scope(self, nodeid: str) -> str:
        return nodeid if nodeid.endswith("]") else nodeid.partition("::")[0]

    def remove_node(self, node: Any) -> str | None:
        """Drop the case that killed a worker; xdist would give it to the next worker, until none is left."""
        crashed: str | None = super().remove_node(node)
        for scope, unit in list(self.workqueue.items()):
            unit.update({case: True for case in unit if case == crashed})
            if all(unit.values()):
                del self.workqueue[scope]
        return crashed
