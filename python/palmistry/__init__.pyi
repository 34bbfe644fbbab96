from . import answers as answers
from . import cluster as cluster
from . import errors as errors
from . import recheck as recheck
from . import system as system
from . import tables as tables
from .answers import Certificate as Certificate
from .answers import Claim as Claim
from .answers import Claims as Claims
from .answers import Observation as Observation
from .answers import Page as Page
from .answers import Rank as Rank
from .answers import Value as Value
from .answers import Verdicts as Verdicts
from .errors import Error as Error
from .errors import EvaluationError as EvaluationError
from .errors import ReadError as ReadError
from .system import System as System
from .system import latex as latex
from .system import observe as observe
from .system import verify as verify
from .tables import Table as Table
from .translation import from_casadi as from_casadi
from .translation import from_sympy as from_sympy

__all__: list[str]
