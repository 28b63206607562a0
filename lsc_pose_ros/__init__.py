"""Human joints in 3-D from one depth image and a person mask.

The method is that of He, Wang, Liao and Xue (Neurocomputing 2015).
"""

__version__ = '0.1.0'
